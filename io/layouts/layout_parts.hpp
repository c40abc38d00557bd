#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/image_file.hpp"
#include "io/layouts/layouts.hpp"

/// What the layouts have in common.
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

/// Images in a folder, by name. A file counts by its content, or by its name when the content is damaged.
std::vector<std::filesystem::path> listImages(const std::filesystem::path& folder);
/// The images of two folders in pairs, all of them: by name, or else by order.
std::vector<FramePaths> pairImages(const std::filesystem::path& left_folder, const std::filesystem::path& right_folder);
/// The number at the end of an image's name; empty where there is none.
std::optional<std::int64_t> imageNumber(const std::filesystem::path& image);
using ImagesByNumber = std::map<std::int64_t, std::filesystem::path>;
/// Of a folder, those that have a number. Throws InputError where there is no image.
ImagesByNumber imagesByNumber(const std::filesystem::path& folder);
/// Pairs whose numbers differ by no more than that; images without a partner are left out.
struct NumberedFrames {
  std::vector<FramePaths> frames;
  std::vector<std::int64_t> numbers;  // of the left images, increasing
};
NumberedFrames pairByNumber(const ImagesByNumber& left, const ImagesByNumber& right, std::int64_t most_apart = 0);
/// The same where the numbers are times in nanoseconds; cameras that are triggered together tell times that differ by
/// less than this.
inline constexpr std::int64_t kMostApart_ns = 5'000'000;
void setStampedFrames(Sequence& sequence, const ImagesByNumber& left, const ImagesByNumber& right);

/// Sets the times from a file, or from the rate where that is empty.
void setStamps(Sequence& sequence, const std::filesystem::path& times_file, double fps_hz);
/// Sets the camera, with the size that the images agree on: what the user gives comes before what the layout has, which
/// is only asked for when it is needed, and may set a rectification instead.
using LayoutCamera = std::function<StereoCamera(ImageSize)>;
void setCamera(Sequence& sequence, const GivenCameras& given, const LayoutCamera& layouts_own);
/// The camera of a pair that is rectified on the way; keeps how.
StereoCamera rectifiedCamera(Sequence& sequence, const Rig& rig, ImageSize size);

}  // namespace motorcade
