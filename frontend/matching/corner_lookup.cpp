#include "frontend/matching/corner_lookup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>

#include "core/instruction_set.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/matching/corner_search.hpp"

#define HWY_TARGET_INCLUDE "frontend/matching/corner_lookup.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {

/// Sum of the absolute differences of the pixels.
int differenceOfPixels(const std::uint8_t* a, const std::uint8_t* b) {
  int sum = 0;
  for (int i = 0; i < Signature::kPixels; ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

void fillSignature(const Image& image, int x, int y, std::uint8_t* out) {
  constexpr int kSide = Signature::kSide;
  static_assert(2 * kSide == kWordLanes);
  std::array<Words, kSide / 2> pixels;
  Words sums{};
  for (int i = 0; i < kSide / 2; ++i)
    sums += pixels[i] = wordPixels(image.row(y + 2 * i) + x, image.row(y + 2 * i + 1) + x);
  constexpr int kMeanGray = 128;
  const Words shift = allWords(kMeanGray - total(products(sums, allWords(1))) / (kSide * kSide));
  for (int i = 0; i < kSide / 2; ++i)
    storeWordsAsBytes(out + i * kWordLanes, lesser(greater(pixels[i] + shift, allWords(0)), allWords(UINT8_MAX)));
}

/// Takes the corners that were found within the bounds one by one, without a branch: which of them looks more like the
/// point is unforeseeable.
void compareFound(CornerSearch& search) {
  for (const int place : std::span(search.within).first(search.count)) {
    const int difference = differenceOfPixels(search.look->pixels(), search.signatures[place].pixels());
    const std::int64_t candidate = CornerSearch::key(difference, search.corners[place]);
    search.second = motorcade::lesser(search.second, motorcade::greater(search.first, candidate));
    search.first = motorcade::lesser(search.first, candidate);
  }
  search.count = 0;
}

void findWithin(CornerSearch& search, const Eigen::Vector2f& point_px, const ShiftBounds& bounds, int begin, int end) {
  const Floats u = point_px.x(), v = point_px.y();
  for (int i = begin; i < end; i += kFloatLanes) {
    const Floats du = load(search.us_px + i) - u, dv = load(search.vs_px + i) - v;
    const unsigned inside = bitsOf((du >= bounds.min_du_px) & (du <= bounds.max_du_px) & (dv >= bounds.min_dv_px) &
                                   (dv <= bounds.max_dv_px)) &
                            ((1U << std::min(end - i, kFloatLanes)) - 1);
    for (int k = 0; k < kFloatLanes; ++k) {
      search.within[search.count] = i + k;
      search.count += inside >> k & 1;
    }
    if (search.count > search.within.size() - kFloatLanes) compareFound(search);
  }
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(differenceOfPixels);
MOTORCADE_EXPORT(fillSignature);
MOTORCADE_EXPORT(compareFound);
MOTORCADE_EXPORT(findWithin);

Signature::Signature(const ImagePyramid& pyramid, float u_px, float v_px) {
  const int last_level = static_cast<int>(pyramid.levels.size()) - 1;
  const auto fill = MOTORCADE_KERNEL(fillSignature);
  for (int level = 0; level < 2; ++level) {
    const Image& image = pyramid.levels[std::min(level, last_level)];
    const auto start = [&](float px, int size) {
      const int nearest = static_cast<int>(std::floor(double{toLevel(px, level)} + 0.5));
      return std::clamp(nearest - kSide / 2, 0, size - kSide);
    };
    const int x = start(u_px, image.width()), y = start(v_px, image.height());
    fill(image, x, y, values_.data() + level * kSide * kSide);
  }
}

int Signature::distance(const Signature& other) const {
  return MOTORCADE_KERNEL(differenceOfPixels)(pixels(), other.pixels());
}

CornerLookup::CornerLookup(const Features& features)
    : corners_(features.corners),
      grid_(features.corners, features.left.levels.front().width(), features.left.levels.front().height(),
            [](const Corner& c) { return Eigen::Vector2f(c.u_px, c.v_px); }),
      us_px_(corners_.size() + HWY_NAMESPACE::kFloatLanes),
      vs_px_(corners_.size() + HWY_NAMESPACE::kFloatLanes) {
  signatures_.reserve(corners_.size());
  for (const int i : grid_.byPlace()) {
    const Corner& corner = corners_[i];
    us_px_[signatures_.size()] = corner.u_px;
    vs_px_[signatures_.size()] = corner.v_px;
    signatures_.emplace_back(features.left, corner.u_px, corner.v_px);
  }
}

void CornerLookup::addSimilar(const Signature& look, const Eigen::Vector2f& point_px, const ShiftBounds& bounds,
                              double max_difference, Guesses& guesses) const {
  const std::int64_t none = CornerSearch::key(static_cast<int>(max_difference * Signature::kPixels), 0);
  CornerSearch search;
  search.us_px = us_px_.data(), search.vs_px = vs_px_.data();
  search.signatures = signatures_.data(), search.corners = grid_.byPlace().data(), search.look = &look;
  search.first = search.second = none;
  const Eigen::Vector2f first(bounds.min_du_px, bounds.min_dv_px), last(bounds.max_du_px, bounds.max_dv_px);
  const auto find = MOTORCADE_KERNEL(findWithin);
  grid_.forEachRangeNear(point_px + first, point_px + last,
                         [&](int begin, int end) { find(search, point_px, bounds, begin, end); });
  MOTORCADE_KERNEL(compareFound)(search);
  for (const std::int64_t found : {search.first, search.second}) {
    if (found == none) return;
    const Corner& corner = corners_[found & UINT32_MAX];
    guesses.add({corner.u_px - point_px.x(), corner.v_px - point_px.y()});
  }
}

}  // namespace motorcade
#endif
