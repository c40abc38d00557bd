#include "io/images/image_codec.hpp"

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/images/image_limits.hpp"

namespace motorcade {
namespace {

constexpr int kMinSide_px = 16, kMaxSide_px = 16384;

}  // namespace

std::string readImageBytes(const std::filesystem::path& file, int max_mb) {
  constexpr std::size_t kMegabyte = std::size_t{1} << 20;
  return readWhole(file, static_cast<std::size_t>(max_mb) * kMegabyte);
}

ImageSize checkedSize(std::uint64_t width, std::uint64_t height, const std::filesystem::path& file) {
  const auto bad = [](std::uint64_t side) { return side < kMinSide_px || side > kMaxSide_px; };
  if (bad(width) || bad(height)) {
    throw InputError(file.string() + ": its header tells " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels; each side must lie between " + std::to_string(kMinSide_px) + " and " +
                     std::to_string(kMaxSide_px));
  }
  if (width * height > kMaxImage_pixels) {
    throw InputError(file.string() + ": its header tells " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels, more than " + std::to_string(kMaxImage_pixels) + "; make the images smaller");
  }
  return {static_cast<int>(width), static_cast<int>(height)};
}

[[noreturn]] void failDamaged(const std::filesystem::path& file, const std::string& why) {
  throw InputError(file.string() + ": damaged image: " + why);
}

std::vector<std::uint8_t*> rowPointers(std::uint8_t* first, int height, std::size_t stride) {
  std::vector<std::uint8_t*> rows(height);
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = first + y * stride;
  return rows;
}

}  // namespace motorcade
