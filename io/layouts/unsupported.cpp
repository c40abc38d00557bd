#include "io/layouts/unsupported.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <exception>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "io/files/file_names.hpp"
#include "io/images/image_file.hpp"
#include "io/sequence/image_names.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kThen =
    "\nLay the calibration beside them (DRIVE/calib.txt, camchain.yaml or left.yaml and right.yaml), or give it, with "
    "--calibration FILE.yaml instead of --camera where the images are not rectified:\n"
    "  motorcade run DRIVE --camera fx,fy,cx,cy,baseline --out RUN";
constexpr const char* kMakeFolders = "\n  mkdir -p DRIVE/left DRIVE/right";

std::string lowerExtension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

template <std::size_t N>
bool isOneOf(const std::string& extension, const std::array<const char*, N>& all) {
  return std::ranges::find(all, extension) != all.end();
}

bool isBag(const fs::path& file) { return isOneOf(lowerExtension(file), std::array{".bag", ".mcap", ".db3"}); }

bool isVideo(const fs::path& file) {
  return isOneOf(lowerExtension(file), std::array{".mp4", ".avi", ".mkv", ".mov", ".webm", ".m4v", ".mpg", ".mpeg",
                                                  ".ts", ".h264", ".h265", ".hevc", ".264", ".265", ".wmv"});
}

/// A Python program between a shell's quotes; names in it stand between double quotes.
std::string pythonCommand(const std::string& program) { return "\n  python3 -c " + shellWord(program); }

std::string pythonText(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted.push_back('\\');
    quoted.push_back(letter);
  }
  quoted.push_back('"');
  return quoted;
}

constexpr const char* kTopics = " (the first command names the topics: write them in place of /LEFT and /RIGHT)";
constexpr const char* kTopicSides = "side = {\"/LEFT/image_raw\": \"left\", \"/RIGHT/image_raw\": \"right\"}\n";

/// Images are named by their times, so that they find their partner.
std::string ofRos1(const fs::path& bag) {
  return kTopics + std::string("\n  rosbag info ") + shellWord(bag.string()) + kMakeFolders +
         pythonCommand(std::string("import rosbag, cv2, cv_bridge\n") + kTopicSides +
                       "for topic, message, _ in rosbag.Bag(" + pythonText(bag.string()) +
                       ").read_messages(list(side)):\n"
                       "  image = cv_bridge.CvBridge().imgmsg_to_cv2(message, \"mono8\")\n"
                       "  cv2.imwrite(\"DRIVE/%s/%d.png\" % (side[topic], message.header.stamp.to_nsec()), image)");
}

std::string ofRos2(const fs::path& bag) {
  const std::string storage = lowerExtension(bag) == ".mcap" ? "mcap" : "sqlite3";
  return kTopics + std::string("\n  ros2 bag info ") + shellWord(bag.string()) + kMakeFolders +
         pythonCommand(std::string("import rosbag2_py, cv2, cv_bridge\n"
                                   "from rclpy.serialization import deserialize_message\n"
                                   "from sensor_msgs.msg import Image\n") +
                       kTopicSides + "bag = rosbag2_py.SequentialReader()\nbag.open(rosbag2_py.StorageOptions(uri=" +
                       pythonText(bag.string()) + ", storage_id=\"" + storage +
                       "\"), rosbag2_py.ConverterOptions(\"cdr\", \"cdr\"))\n"
                       "while bag.has_next():\n"
                       "  topic, data, _ = bag.read_next()\n"
                       "  if topic not in side: continue\n"
                       "  message = deserialize_message(data, Image)\n"
                       "  time = \"%d%09d\" % (message.header.stamp.sec, message.header.stamp.nanosec)\n"
                       "  image = cv_bridge.CvBridge().imgmsg_to_cv2(message, \"mono8\")\n"
                       "  cv2.imwrite(\"DRIVE/%s/%s.png\" % (side[topic], time), image)");
}

std::string ofVideo(const fs::path& video) {
  const std::string from = "\n  ffmpeg -i " + shellWord(video.string());
  return "\nwhere it shows left and right side by side:" + std::string(kMakeFolders) + from +
         " -vf crop=iw/2:ih:0:0 DRIVE/left/%06d.png -vf crop=iw/2:ih:iw/2:0 DRIVE/right/%06d.png"
         "\nwhere it is that of the left camera, and the right one's, with as many images, goes to DRIVE/right alike:" +
         kMakeFolders + from + " DRIVE/left/%06d.png";
}

/// Image files whose names match, as a shell finds them.
std::string shellPattern(const fs::path& folder, const std::string& pattern) {
  std::string text = shellWord(folder.string()) + "/";
  for (std::size_t begin = 0; begin < pattern.size();) {
    const std::size_t end = std::min(pattern.find('*', begin), pattern.size());
    if (end > begin) text += shellWord(pattern.substr(begin, end - begin));
    if (end < pattern.size() && text.back() != '*') text.push_back('*');
    begin = end + 1;
  }
  return text;
}

/// All images of a folder with the same extension, as a shell finds them.
std::string allLike(const fs::path& image) {
  std::string pattern(1, '*');
  pattern += image.extension().string();
  return shellPattern(image.parent_path(), pattern);
}

/// The names of a group of images as a pattern, with wildcards for digits that differ.
std::string patternOf(const std::vector<NameParts>& names, const std::set<std::size_t>& kept,
                      const std::string& extension) {
  std::string pattern;
  for (std::size_t part = 0; part < names.front().size(); ++part)
    pattern += part % 2 == 0 || kept.contains(part) ? names.front()[part] : "*";
  return pattern + extension;
}

/// Patterns of two groups of images, split by words that differ in their names, or by a digit that has two values.
std::optional<std::pair<std::string, std::string>> twoGroups(const std::vector<fs::path>& images) {
  std::map<std::string, std::vector<NameParts>> kinds;
  for (const fs::path& image : images) {
    const NameParts parts = partsOfName(image.stem().string());
    std::string kind;
    for (std::size_t i = 0; i < parts.size(); i += 2) kind += parts[i] + "#";
    kinds[kind].push_back(parts);
  }
  const std::string extension = images.front().extension().string();
  if (kinds.size() == 2)
    return std::pair(patternOf(kinds.begin()->second, {}, extension), patternOf(kinds.rbegin()->second, {}, extension));
  if (kinds.size() != 1 || images.size() < 4) return std::nullopt;
  for (std::size_t part = 1; part < kinds.begin()->second.front().size(); part += 2) {
    std::map<std::string, std::vector<NameParts>> by_digits;
    for (const NameParts& name : kinds.begin()->second) by_digits[name[part]].push_back(name);
    if (by_digits.size() == 2)
      return std::pair(patternOf(by_digits.begin()->second, {part}, extension),
                       patternOf(by_digits.rbegin()->second, {part}, extension));
  }
  return std::nullopt;
}

std::string ofTwoGroups(const fs::path& folder, const std::pair<std::string, std::string>& patterns) {
  return "\nTwo sets of images become a sequence in folders named left and right (exchange them where the first set is "
         "the right camera's):" +
         std::string(kMakeFolders) + "\n  ln -s -t DRIVE/left " + shellPattern(folder, patterns.first) +
         "\n  ln -s -t DRIVE/right " + shellPattern(folder, patterns.second) + kThen;
}

/// True for images at least twice as wide as high: each may be a pair.
bool mayBeSideBySide(const fs::path& image) {
  try {
    const ImageSize size = readImageSize(image);
    return size.width >= 2 * size.height;
  } catch (const std::exception&) {
    return false;
  }
}

std::string ofSideBySide(const fs::path& image) {
  const std::string all = allLike(image);
  const auto cut = [&](const char* side, const char* where) {
    return std::string("\n  mogrify -path DRIVE/") + side + " -gravity " + where + " -crop 50%x100%+0+0 +repage " + all;
  };
  return "\nImages with left and right side by side are not read; ImageMagick cuts them:" + std::string(kMakeFolders) +
         cut("left", "West") + cut("right", "East") + kThen;
}

}  // namespace

bool isRecordingFile(const fs::path& file) { return isBag(file) || isVideo(file) || lowerExtension(file) == ".svo"; }

std::string adviceOnFile(const fs::path& file) {
  if (lowerExtension(file) == ".bag")
    return ": is a bag of ROS 1's own format, which is not read; write it as MCAP, which `run` reads\n  mcap convert " +
           shellWord(file.string()) + " DRIVE.mcap\n  motorcade run DRIVE.mcap\nor write its images into two folders" +
           ofRos1(file) + kThen;
  if (isBag(file))
    return ": is a bag of messages, which `run` alone reads\n  motorcade run " + shellWord(file.string()) +
           "\nFor other commands, write its images into two folders" + ofRos2(file) + kThen;
  if (isVideo(file))
    return ": is a video, which is not read; write its images into two folders," + ofVideo(file) + kThen;
  if (lowerExtension(file) == ".svo")
    return ": is a recording of a ZED camera, which is not read; write its rectified images into a folder with the ZED "
           "SDK's export, and name that folder for the next step\n  mkdir -p DRIVE/images\n  ZED_SVO_Export " +
           shellWord(file.string()) + " DRIVE/images/ 2";
  return ": is one image; name the folder of a sequence";
}

std::vector<fs::path> otherImages(const fs::path& folder) {
  std::vector<fs::path> images = listFolder(folder);
  std::erase_if(images, [](const fs::path& file) {
    return !isOneOf(lowerExtension(file), std::array{".tif", ".tiff", ".bmp", ".webp", ".ppm", ".pnm", ".exr", ".gif",
                                                     ".jp2", ".heic", ".avif"});
  });
  return images;
}

std::string adviceOnOtherImages(const std::vector<fs::path>& images) {
  const fs::path& first = images.front();
  return "images ending with " + first.extension().string() +
         " are not read; ImageMagick writes PNG files beside them:\n  mogrify -format png " + allLike(first);
}

std::string adviceOnOneFolder(const std::vector<fs::path>& images) {
  const fs::path folder = images.front().parent_path();
  if (const auto groups = twoGroups(images)) return ofTwoGroups(folder, *groups);
  std::string text =
      "\nA sequence has two folders, left and right, with the images of one camera each; these are one set.";
  if (mayBeSideBySide(images.front())) text += ofSideBySide(images.front());
  return text;
}

std::string adviceOnTwoFolders(const fs::path& left, const fs::path& right) {
  return "\nTwo folders of images become a sequence as left and right (exchange them where the first is the right "
         "camera's):\n  mkdir -p DRIVE\n  ln -s " +
         shellWord(left.string()) + " DRIVE/left\n  ln -s " + shellWord(right.string()) + " DRIVE/right" + kThen;
}

}  // namespace motorcade
