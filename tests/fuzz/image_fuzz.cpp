#include <array>

#include "io/images/image_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

namespace {

/// Uses each pixel, so that the sanitizers look at it.
unsigned sumOf(const Image& image) {
  unsigned sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) sum += image.row(y)[x];
  return sum;
}

}  // namespace

/// A PNG, JPEG or PGM; its header alone, its pixels as gray, and as the 16 bits of a mask.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  static volatile unsigned sum = 0;
  constexpr std::array<std::string_view, 1> kNoLine{": "};  // an image has none
  const auto& path = file.holding(fuzz::textOf(data, size));
  ImagePool pool;
  ImageSize told;
  fuzz::readOrRefuse(path.native(), kNoLine, [&] { told = readImageSize(path); });
  fuzz::readOrRefuse(path.native(), kNoLine, [&] {
    const Image image = readImage(path, pool);
    fuzz::require(ImageSize{image.width(), image.height()} == told, "a size that is not the header's");
    sum = sumOf(image);
  });
  fuzz::readOrRefuse(path.native(), kNoLine, [&] {
    for (const std::uint16_t value : readPng16(path).pixels) sum = sum + value;
  });
  return 0;
}
