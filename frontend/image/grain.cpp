#include "frontend/image/grain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/image/grain.cpp"
#include <hwy/foreach_target.h>

#include "core/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kGrainHalfWindow_px = 3;
constexpr int kGrainWindowPixels = (2 * kGrainHalfWindow_px + 1) * (2 * kGrainHalfWindow_px + 1);
constexpr int kWhole = 16;    // of the share, in sixteenths
constexpr int kReach_px = 2;  // of the binomial window

/// Sums of a column of the image under the weights 1, 4, 6, 4, 1; rows beyond the border repeat the last.
void columnSums(const Image& image, int y, std::uint16_t* sums) {
  const auto row = [&](int dy) { return image.row(std::clamp(y + dy, 0, image.height() - 1)); };
  const std::uint8_t *a = row(-2), *b = row(-1), *c = row(0), *d = row(1), *e = row(2);
  for (int x = 0; x < image.width(); ++x)
    sums[x] = static_cast<std::uint16_t>(a[x] + e[x] + 4 * (b[x] + d[x]) + 6 * c[x]);
}

/// A row, by `share` sixteenths replaced by its smoothed values. `sums` holds the columns' from 2 px before the row on.
void blendRow(const std::uint8_t* row, const std::uint16_t* sums, int share, int width, std::uint8_t* out) {
  constexpr int kWeight = 256, kHalf = 128;
  for (int x = 0; x < width; ++x) {
    const int sum = sums[x] + sums[x + 4] + 4 * (sums[x + 1] + sums[x + 3]) + 6 * sums[x + 2];
    const int smooth = (sum + kHalf) / kWeight;
    out[x] = static_cast<std::uint8_t>((kWhole * row[x] + share * (smooth - row[x]) + kWhole / 2) / kWhole);
  }
}

}  // namespace

float grainAt(const Image& image, int x, int y) {
  int squares = 0;
  for (int r = y - kGrainHalfWindow_px; r <= y + kGrainHalfWindow_px; ++r) {
    const std::uint8_t *above = image.row(r - 1), *row = image.row(r), *below = image.row(r + 1);
    for (int c = x - kGrainHalfWindow_px; c <= x + kGrainHalfWindow_px; ++c) {
      const int rough = above[c - 1] + above[c + 1] + below[c - 1] + below[c + 1] -
                        2 * (above[c] + row[c - 1] + row[c + 1] + below[c]) + 4 * row[c];
      squares += rough * rough;
    }
  }
  return std::sqrt(static_cast<float>(squares) / (36.0F * kGrainWindowPixels));
}

/// The image, by some sixteenths replaced by its mean under the binomial window.
Image smoothed(const Image& image, int sixteenths, ImagePool& pool) {
  Image smooth = pool.acquire(image.width(), image.height());
  std::vector<std::uint16_t> sums(static_cast<std::size_t>(image.width() + 2 * kReach_px));
  for (int y = 0; y < image.height(); ++y) {
    columnSums(image, y, sums.data() + kReach_px);
    std::fill_n(sums.begin(), kReach_px, sums[kReach_px]);
    std::fill_n(sums.end() - kReach_px, kReach_px, sums[sums.size() - kReach_px - 1]);
    blendRow(image.row(y), sums.data(), sixteenths, image.width(), smooth.mutableRow(y));
  }
  return smooth;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(grainAt);
MOTORCADE_EXPORT(smoothed);

namespace {

constexpr int kGrid_px = 40;
constexpr std::size_t kMinNeighborhoods = 12;

/// Grain up to which images stay as they are, and from which on all of an image is smoothed. At 10, smoothed images
/// lose more accuracy of the path than they gain; at 20, matches in images that are not smoothed are half as many.
constexpr float kHarmlessGrain = 8, kSmoothedGrain = 16;
constexpr float kUsualContrast = 75;  // gray levels, of the real drives on which these were measured
constexpr float kWeightOfRelative = 0.5F;

/// The value below which so many quarters of the values lie.
float quartile(std::vector<float>& values, std::ptrdiff_t quarters) {
  const auto at = values.begin() + std::ssize(values) * quarters / 4;
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace

float grainAround(const Image& image, int x, int y) { return MOTORCADE_KERNEL(grainAt)(image, x, y); }

Grain Grain::with(const Grain& other) const {
  return {std::max(smooth_gray, other.smooth_gray), std::max(relative_gray, other.relative_gray)};
}

std::optional<Grain> grainOf(const Image& image) {
  constexpr std::uint8_t kWhite = 255;
  constexpr float kMedianOverFirstQuartile = 1.15F;  // of the neighborhoods' grains, in white noise
  std::vector<float> grains, levels;
  for (int y = kGrid_px / 2; y < image.height() - HWY_NAMESPACE::kGrainHalfWindow_px - 1; y += kGrid_px) {
    for (int x = kGrid_px / 2; x < image.width() - HWY_NAMESPACE::kGrainHalfWindow_px - 1; x += kGrid_px) {
      const std::uint8_t gray = image.at(x, y);
      if (gray == 0 || gray == kWhite) continue;
      grains.push_back(grainAround(image, x, y));
      levels.push_back(gray);
    }
  }
  if (grains.size() < kMinNeighborhoods) return std::nullopt;
  const float contrast = std::max(quartile(levels, 3) - quartile(levels, 1), 1.0F);
  return Grain{.smooth_gray = quartile(grains, 1),
               .relative_gray = quartile(grains, 2) / kMedianOverFirstQuartile * kUsualContrast / contrast};
}

Image denoised(const Image& image, const Grain& grain, ImagePool& pool) {
  const float counts = std::max(grain.smooth_gray, kWeightOfRelative * grain.relative_gray);
  const float share = std::clamp((counts - kHarmlessGrain) / (kSmoothedGrain - kHarmlessGrain), 0.0F, 1.0F);
  const int sixteenths = static_cast<int>(std::lround(share * HWY_NAMESPACE::kWhole));
  return sixteenths == 0 ? image : MOTORCADE_KERNEL(smoothed)(image, sixteenths, pool);
}

}  // namespace motorcade
#endif
