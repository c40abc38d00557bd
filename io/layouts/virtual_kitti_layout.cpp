#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "io/files/errors.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/truth/virtual_kitti.hpp"

/// Virtual KITTI 2: SceneNN/VARIATION with frames/rgb/Camera_0 and Camera_1. The tables and the instances are archives
/// of their own. They may be unpacked over the images, into a folder beside them or beside their scenes.
namespace motorcade {
namespace {

namespace fs = std::filesystem;

const char* const kTextArchive = "vkitti_2.0.3_textgt.tar.gz";

fs::path variationImages(const fs::path& variation, const char* camera) {
  return variation / "frames" / "rgb" / camera;
}

bool isVariation(const fs::path& folder) {
  return fs::is_directory(variationImages(folder, "Camera_0")) && fs::is_directory(variationImages(folder, "Camera_1"));
}

std::vector<fs::path> foldersIn(const fs::path& folder) {
  std::vector<fs::path> folders;
  std::error_code unreadable;
  for (const auto& entry : fs::directory_iterator(folder, unreadable))
    if (entry.is_directory()) folders.push_back(entry.path());
  std::ranges::sort(folders);
  return folders;
}

/// The folders that may hold a variation's files: its own, and those of the same scene and variation in folders of
/// other archives.
std::vector<fs::path> placesOf(const fs::path& variation) {
  const fs::path root = variation.parent_path().parent_path();
  const fs::path inside = variation.parent_path().filename() / variation.filename();
  std::vector<fs::path> places{variation};
  for (const fs::path& around : {root.parent_path(), root})
    for (const fs::path& other : foldersIn(around))
      if (other.filename().string().starts_with("vkitti") && other != root && fs::is_directory(other / inside))
        places.push_back(other / inside);
  return places;
}

/// The first of the places that has a file or folder; empty where none has.
fs::path placeWith(const std::vector<fs::path>& places, const fs::path& file) {
  const auto found = std::ranges::find_if(places, [&](const fs::path& place) { return fs::exists(place / file); });
  return found == places.end() ? fs::path() : *found;
}

/// The masks' folder. The masks name their frames as the tables do, and are used only where the drive has all frames.
fs::path instancesOf(const Sequence& sequence, const std::vector<fs::path>& places) {
  for (std::size_t i = 0; i < sequence.frames.size(); ++i)
    if (imageNumber(sequence.frames[i].left) != static_cast<std::int64_t>(i)) return {};
  const fs::path instances = fs::path("frames") / "instanceSegmentation" / "Camera_0";
  const fs::path place = placeWith(places, instances);
  return place.empty() ? place : place / instances;
}

}  // namespace

std::vector<std::string> virtualKittiVariations(const fs::path& folder) {
  std::vector<std::string> variations;
  for (const fs::path& inside : foldersIn(folder)) {
    if (isVariation(inside)) variations.push_back(inside.filename().string());
    if (!inside.filename().string().starts_with("Scene")) continue;
    for (const fs::path& variation : foldersIn(inside))
      if (isVariation(variation)) variations.push_back((inside.filename() / variation.filename()).string());
  }
  return variations;
}

std::optional<Sequence> openVirtualKitti(const SequenceSource& source) {
  const fs::path& folder = source.path;
  if (!isVariation(folder)) return std::nullopt;
  const auto places = placesOf(folder);
  Sequence sequence{.folder = folder, .layout = "virtual_kitti", .pair = CameraPair::kColor};
  setFrames(sequence, variationImages(folder, "Camera_0"), variationImages(folder, "Camera_1"));
  setCamera(sequence, source.given, [&](ImageSize) {
    const fs::path place = placeWith(places, "intrinsic.txt");
    return readVirtualKittiCamera(
        neededFile((place.empty() ? folder : place) / "intrinsic.txt",
                   std::string("unpack Virtual KITTI 2's ") + kTextArchive +
                       " over the images or beside them, or give --camera 725.0087,725.0087,620.5,187,0.532725")
            .parent_path());
  });
  setStamps(sequence, {}, source.fps_hz);
  sequence.truth.virtual_kitti = placeWith(places, "extrinsic.txt");
  if (!sequence.truth.virtual_kitti.empty()) sequence.truth.instances = instancesOf(sequence, places);
  return sequence;
}

}  // namespace motorcade
