#include <array>
#include <filesystem>
#include <string_view>

#include "io/bag/bag_drive.hpp"
#include "io/bag/bag_pairs.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

namespace {

constexpr std::array<std::string_view, 7> kNoLine{"ROS 1",       "byte ", "message ", "database",
                                                  "camera_info", "MCAP",  "pair"};
constexpr const char* kTopics = "/l/i,/r/i";

/// All that may be read of a bag, whatever its beginning tells.
void readPairs(const std::filesystem::path& file) {
  constexpr int kMost_pixels = 1 << 16;
  BagPairs pairs(file, parseImageTopics(kTopics), BagPairs::Infos::kTake);
  ImagePool pool;
  while (const auto pair = pairs.next())
    for (const BagImage* image : {&pair->left, &pair->right}) {
      const ImageSize size = image->header().size;
      if (size.width * size.height > kMost_pixels) return;
      fuzz::require(image->gray(pool, {}).width() == size.width, "an image of another size");
      image->brightestSample();
    }
}

}  // namespace

/// A file of either kind, with a few small images.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  const std::filesystem::path& path = file.holding(fuzz::textOf(data, size));
  for (const auto read : {+[](const std::filesystem::path& bag) { openBagDrive(bag, kTopics, {}); }, readPairs})
    fuzz::readOrRefuse(path.string(), kNoLine, [&] {
      try {
        read(path);
      } catch (const UsageError&) {  // lists the topics, which may be many
      }
    });
  return 0;
}
