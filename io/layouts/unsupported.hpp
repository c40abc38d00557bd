#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Recordings that are not read, and how they become folders of images that are.
namespace motorcade {

/// A recording in one file: a bag of messages or a video.
bool isRecordingFile(const std::filesystem::path& file);
/// What a file is that is no list of images, and what to run, as it can be pasted into a shell.
std::string adviceOnFile(const std::filesystem::path& file);

/// Images of a kind that is not read, by name.
std::vector<std::filesystem::path> otherImages(const std::filesystem::path& folder);
/// How these images of one folder become PNG files.
std::string adviceOnOtherImages(const std::vector<std::filesystem::path>& images);

/// How images that lie all in one folder become a sequence: those of both cameras, or each with both sides in it.
std::string adviceOnOneFolder(const std::vector<std::filesystem::path>& images);
/// How two folders of images become a sequence.
std::string adviceOnTwoFolders(const std::filesystem::path& left, const std::filesystem::path& right);

}  // namespace motorcade
