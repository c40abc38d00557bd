#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/images/image_file.hpp"
#include "io/layouts/layouts.hpp"
#include "io/sequence/image_names.hpp"
#include "io/sequence/timestamps.hpp"

/// Functions that the layouts share.
namespace motorcade {

struct Rig;

/// Two folders of images that belong together.
struct PairNames {
  const char *left, *right;
  CameraPair pair;
};
inline constexpr std::array kPairs = {
    PairNames{"image_0", "image_1", CameraPair::kGray},  PairNames{"image_00", "image_01", CameraPair::kGray},
    PairNames{"left", "right", CameraPair::kGray},       PairNames{"cam0", "cam1", CameraPair::kGray},
    PairNames{"image_2", "image_3", CameraPair::kColor}, PairNames{"image_02", "image_03", CameraPair::kColor}};

/// The path, or an empty one where nothing is there.
std::filesystem::path ifExists(const std::filesystem::path& file);
/// The path; throws InputError where nothing is there.
std::filesystem::path neededFile(const std::filesystem::path& file, const std::string& why);

/// Images in a folder, in natural order. A file counts by its content, or by its name when the content is damaged.
std::vector<std::filesystem::path> listImages(const std::filesystem::path& folder);
/// The same; throws InputError where there is none.
std::vector<std::filesystem::path> imagesIn(const std::filesystem::path& folder);
/// Those images of a folder whose names have a number. Throws InputError where there is no image.
ImagesByNumber imagesByNumber(const std::filesystem::path& folder);

/// The frames of two folders: by numbers or times in the names, or else in order.
void setFrames(Sequence& sequence, const std::filesystem::path& left_folder, const std::filesystem::path& right_folder);
/// Sets the frames from images whose times are known, which become stamps, or whose numbers are (`kNames`). Leaves out
/// single images before the first pair or after the last. Returns the frames' numbers.
std::vector<std::int64_t> setKeyedFrames(Sequence& sequence, const KeyedImages& images);

/// Sets the times from a file; where that is empty, leaves those that the names told, or takes the rate.
void setStamps(Sequence& sequence, const std::filesystem::path& times_file, double fps_hz);
/// Adds a note where the numbers in a file of times are no seconds.
void tellUnit(Sequence& sequence, const Times& times, const std::filesystem::path& file);
/// Sets the camera, with the size that the images agree on. The user's camera takes precedence over the layout's own,
/// which is asked for only when needed and may set a rectification instead.
using LayoutCamera = std::function<StereoCamera(ImageSize)>;
void setCamera(Sequence& sequence, const GivenCameras& given, const LayoutCamera& layouts_own);
/// The camera of a pair that is rectified while it is read; keeps the rectification in the sequence.
StereoCamera rectifiedCamera(Sequence& sequence, const Rig& rig, ImageSize size);

}  // namespace motorcade
