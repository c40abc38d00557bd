#include "frontend/image/image_pyramid.hpp"

#include <cassert>
#include <utility>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/image/image_pyramid.cpp"
#include <hwy/foreach_target.h>

#include "core/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
void halveRow(const std::uint8_t* upper, const std::uint8_t* lower, std::uint8_t* out, int width) {
  for (int x = 0; x < width; ++x) {
    const int sum = upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1];
    out[x] = static_cast<std::uint8_t>((sum + 2) >> 2);
  }
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(halveRow);

Image halved(const Image& image, ImagePool& pool) {
  Image half = pool.acquire(image.width() / 2, image.height() / 2);
  const auto halve = MOTORCADE_KERNEL(halveRow);
  for (int y = 0; y < half.height(); ++y)
    halve(image.row(2 * y), image.row(2 * y + 1), half.mutableRow(y), half.width());
  return half;
}

ImagePyramid buildPyramid(const Image& image, int levels, ImagePool& pool) {
  assert(!image.empty() && levels >= 1);
  ImagePyramid pyramid;
  pyramid.levels.reserve(levels);
  pyramid.levels.push_back(image);
  while (static_cast<int>(pyramid.levels.size()) < levels) {
    const Image& last = pyramid.levels.back();
    if (last.width() / 2 < kMinPyramidSide_px || last.height() / 2 < kMinPyramidSide_px) break;
    Image half = halved(last, pool);
    pyramid.levels.push_back(std::move(half));
  }
  return pyramid;
}

}  // namespace motorcade
#endif
