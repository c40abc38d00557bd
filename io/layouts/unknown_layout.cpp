#include <algorithm>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "io/errors.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostNamed = 6;

/// What a folder holds, as a message tells it.
struct Content {
  std::vector<fs::path> of_images;  // sub-folders with images
  std::vector<std::string> folders, calibrations, bags;
  std::size_t images = 0;
};

std::string numbered(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

Content contentOf(const fs::path& folder) {
  Content content;
  content.images = listImages(folder).size();
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
  std::ranges::sort(entries);
  for (const fs::path& entry : entries) {
    const std::string name = printable(entry.filename().string());
    const std::string extension = entry.extension().string();
    if (fs::is_directory(entry)) {
      const std::size_t images = listImages(entry).size();
      if (images > 0) content.of_images.push_back(entry);
      content.folders.push_back(name + " (" + numbered(images, "image") + ")");
    } else if (extension == ".bag" || extension == ".mcap" || extension == ".db3") {
      content.bags.push_back(name);
    } else if (extension == ".yaml" || extension == ".yml" || extension == ".json" || extension == ".txt") {
      content.calibrations.push_back(name);
    }
  }
  return content;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNamed); ++i) text += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kMostNamed) text += " and " + std::to_string(names.size() - kMostNamed) + " more";
  return text;
}

std::string described(const Content& content) {
  std::string text = numbered(content.images, "image");
  if (!content.folders.empty()) text += "; folders " + listed(content.folders);
  if (!content.calibrations.empty()) text += "; files " + listed(content.calibrations);
  if (!content.bags.empty()) text += "; bags " + listed(content.bags);
  return text;
}

/// The folders in it that are sequences.
std::vector<std::string> sequencesIn(const fs::path& folder) {
  constexpr std::size_t kMostTried = 50;
  std::vector<std::string> names;
  std::size_t tried = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_directory() || ++tried > kMostTried) continue;
    try {
      if (openKnownLayout({entry.path(), 10, {}})) names.push_back(printable(entry.path().filename().string()));
    } catch (const std::exception&) {
      continue;  // it may be one, but not as it is
    }
  }
  std::ranges::sort(names);
  return names;
}

/// What to run so that what there is becomes a sequence.
std::string advice(const fs::path& folder, const Content& content) {
  if (const auto variations = virtualKittiVariations(folder); !variations.empty())
    return "\nThese folders in it are drives of Virtual KITTI 2: " + listed(variations) +
           ". Name one of them, or run all:\n  motorcade batch perf/datasets/virtual_kitti_2.toml --root ROOT --out "
           "BATCH    (ROOT holds Scene01, ...)";
  if (const auto sequences = sequencesIn(folder); !sequences.empty())
    return "\nThese folders in it are sequences: " + listed(sequences) + ". Name one of them.";
  if (content.images == 0 && content.of_images.empty())
    return "\nImages are PNG, JPEG or PGM files: lay those of the left camera into a folder left, those of the right "
           "one "
           "into right, and a calib.txt, camchain.yaml or left.yaml and right.yaml beside them.";
  const bool two = content.of_images.size() >= 2;
  const std::string left = two ? content.of_images[0].string() + "/*" : (folder / "*left*").string(),
                    right = two ? content.of_images[1].string() + "/*" : (folder / "*right*").string();
  return "\nTwo sets of images become a sequence by a list of their pairs, the left one first, and a calibration:\n"
         "  paste -d' ' <(ls -d " +
         left + ") <(ls -d " + right +
         ") > LIST.txt\n"
         "  motorcade run LIST.txt --camera fx,fy,cx,cy,baseline --out RUN    (rectified; else --calibration "
         "FILE.yaml)\n"
         "or by lying in folders named left and right, beside a calib.txt, camchain.yaml or left.yaml and right.yaml.";
}

[[noreturn]] void failBag(const fs::path& bag) {
  const bool first_ros = bag.extension() == ".bag";
  const std::string extract = first_ros ? "rosrun image_view extract_images _sec_per_frame:=0 "
                                        : "ros2 run image_view extract_images --ros-args -p sec_per_frame:=0.0 ";
  const std::string argument = first_ros ? "" : "-r ", format = first_ros ? "_filename_format" : "-p filename_format";
  throw InputError(bag.string() + ": is a bag of messages, which is not read; write its images into two folders,\n  " +
                   extract + argument + "image:=/LEFT/image_raw " + format +
                   ":=DRIVE/left/%06i.png     (the same for RIGHT)\n  " + (first_ros ? "rosbag" : "ros2 bag") +
                   " play " + bag.string() +
                   "\nand lay the calibration beside them: DRIVE/calib.txt, camchain.yaml or left.yaml and right.yaml");
}

}  // namespace

void failUnknownLayout(const fs::path& path) {
  if (fs::is_regular_file(path)) failBag(path);
  const Content content = contentOf(path);
  if (content.bags.size() == 1 && content.folders.empty() && content.images == 0) failBag(path / content.bags.front());
  throw InputError(path.string() + ": holds no stereo sequence that is understood; it holds " + described(content) +
                   "." + advice(path, content));
}

}  // namespace motorcade
