#include "io/bag/bag_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <unistd.h>

#include "io/bag/db3_reader.hpp"
#include "io/bag/mcap_format.hpp"
#include "io/bag/mcap_reader.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/rig/yaml_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSqliteStart("SQLite format 3\0", 16);
constexpr std::string_view kRos1Start = "#ROSBAG V";
constexpr const char* kMetadata = "metadata.yaml";

std::string startOf(const fs::path& file) {
  std::array<char, kSqliteStart.size()> start{};
  const InputFile in = openInput(file);
  const ssize_t got = ::read(in.descriptor.number(), start.data(), start.size());
  return {start.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))};
}

std::string lowerSuffix(const fs::path& file) {
  std::string suffix = file.extension().string();
  std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return suffix;
}

/// The one file that a rosbag2 folder's metadata names.
fs::path fileOfFolder(const fs::path& folder) {
  const fs::path metadata = folder / kMetadata;
  const YamlPart bag = YamlPart::ofFile(metadata).at({"rosbag2_bagfile_information"});
  const auto files = bag.at({"relative_file_paths"}).items();
  if (const auto mode = bag.find({"compression_mode"}); mode && !mode->text().empty() && mode->text() != "none")
    mode->fail("is " + mode->text() + ": decompress the bag with ros2 bag convert");
  if (files.size() != 1)
    bag.fail("names " + std::to_string(files.size()) + " files: give one of them, or join them with ros2 bag convert");
  const fs::path file = files.front().text();
  return folder / (file.has_parent_path() && !fs::exists(folder / file) ? file.filename() : file);
}

}  // namespace

bool isBag(const fs::path& path) {
  if (fs::is_directory(path)) return fs::exists(path / kMetadata);
  if (const std::string suffix = lowerSuffix(path); suffix == ".mcap" || suffix == ".db3") return true;
  if (!fs::is_regular_file(path)) return false;
  try {
    const std::string start = startOf(path);
    return start.starts_with(mcap::kMagic) || start.starts_with(kSqliteStart);
  } catch (const InputError&) {
    return false;
  }
}

std::unique_ptr<BagReader> openBag(const fs::path& path) {
  if (fs::is_directory(path)) return openBag(fileOfFolder(path));
  const std::string start = startOf(path);
  if (start.starts_with(kRos1Start))
    throw InputError(path.string() +
                     ": is a bag of ROS 1's own format; write it anew by\n  mcap convert BAG.bag BAG.mcap");
  if (start.starts_with(kSqliteStart) || (start.empty() && lowerSuffix(path) == ".db3"))
    return std::make_unique<Db3Reader>(path);
  return std::make_unique<McapReader>(path);
}

}  // namespace motorcade
