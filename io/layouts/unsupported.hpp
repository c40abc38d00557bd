#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Recordings that are not read, and how to convert them to folders of images that are.
namespace motorcade {

/// A recording in one file: a bag of messages or a video.
bool isRecordingFile(const std::filesystem::path& file);
/// Names the kind of a file that is not a list of images, and the commands to run, ready to paste into a shell.
std::string adviceOnFile(const std::filesystem::path& file);

/// Images of a kind that is not read, by name.
std::vector<std::filesystem::path> otherImages(const std::filesystem::path& folder);
/// Explains how to convert these images of one folder to PNG files.
std::string adviceOnOtherImages(const std::vector<std::filesystem::path>& images);

/// Explains how images in a single folder become a sequence: those of both cameras, or each showing both sides.
std::string adviceOnOneFolder(const std::vector<std::filesystem::path>& images);
/// Explains how two folders of images become a sequence.
std::string adviceOnTwoFolders(const std::filesystem::path& left, const std::filesystem::path& right);

}  // namespace motorcade
