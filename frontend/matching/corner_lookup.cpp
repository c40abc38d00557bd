#include "frontend/matching/corner_lookup.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>

#include "frontend/image/float_lanes.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/word_lanes.hpp"
#include "frontend/matching/lesser.hpp"

namespace motorcade {
namespace {

using WordBytes = std::uint8_t __attribute__((vector_size(kWordLanes)));

}  // namespace

Signature::Signature(const ImagePyramid& pyramid, float u_px, float v_px) {
  const int last_level = static_cast<int>(pyramid.levels.size()) - 1;
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
  int sum = 0;
  for (std::size_t i = 0; i < values_.size(); ++i) sum += std::abs(values_[i] - other.values_[i]);
  return sum;
}

void Signature::fill(const Image& image, int x, int y, std::uint8_t* out) {
  static_assert(2 * kSide == kWordLanes);
  std::array<Words, kSide / 2> pixels;
  Words sums{};
  for (int i = 0; i < kSide / 2; ++i)
    sums += pixels[i] = wordPixels(image.row(y + 2 * i) + x, image.row(y + 2 * i + 1) + x);
  const WordSums pairs = products(sums, allWords(1));
  constexpr int kMeanGray = 128;
  const Words shift = allWords(kMeanGray - totals(pairs, pairs, pairs, pairs)[0] / (kSide * kSide)), black{},
              white = allWords(255);
  for (int i = 0; i < kSide / 2; ++i) {
    const Words shifted = pixels[i] + shift, above = shifted < black ? black : shifted;
    const auto bytes = __builtin_convertvector(above > white ? white : above, WordBytes);
    std::memcpy(out + i * kWordLanes, &bytes, sizeof bytes);
  }
}

/// Takes corners one by one, without a branch: which of them looks more like the point is unforeseeable.
class CornerLookup::TwoMostSimilar {
 public:
  TwoMostSimilar(const CornerLookup& lookup, const Signature& look, double max_difference)
      : lookup_(lookup),
        look_(look),
        none_(key(static_cast<int>(max_difference * Signature::kPixels), 0)),
        first_(none_),
        second_(none_) {}

  void add(int place) {
    const std::int64_t candidate = key(look_.distance(lookup_.signatures_[place]), lookup_.grid_.byPlace()[place]);
    second_ = lesser(second_, greater(first_, candidate));
    first_ = lesser(first_, candidate);
  }
  void addTo(Guesses& guesses, const Eigen::Vector2f& point_px) const {
    for (const std::int64_t found : {first_, second_}) {
      if (found == none_) return;
      const Corner& corner = lookup_.corners_[found & UINT32_MAX];
      guesses.add({corner.u_px - point_px.x(), corner.v_px - point_px.y()});
    }
  }

 private:
  /// Of the corners that look as similar, the first one is the least.
  static std::int64_t key(int distance, int corner) { return std::int64_t{distance} << 32 | corner; }

  const CornerLookup& lookup_;
  const Signature& look_;
  std::int64_t none_, first_, second_;
};

CornerLookup::CornerLookup(const Features& features)
    : corners_(features.corners),
      grid_(features.corners, features.left.levels.front().width(), features.left.levels.front().height(),
            [](const Corner& c) { return Eigen::Vector2f(c.u_px, c.v_px); }),
      us_px_(corners_.size() + kFloatLanes),
      vs_px_(corners_.size() + kFloatLanes) {
  signatures_.reserve(corners_.size());
  for (const int i : grid_.byPlace()) {
    const Corner& corner = corners_[i];
    us_px_[signatures_.size()] = corner.u_px;
    vs_px_[signatures_.size()] = corner.v_px;
    signatures_.emplace_back(features.left, corner.u_px, corner.v_px);
  }
}

void CornerLookup::addWithin(const Eigen::Vector2f& point_px, const ShiftBounds& bounds, TwoMostSimilar& best) const {
  const Floats u = allFloats(point_px.x()), v = allFloats(point_px.y());
  const Floats min_du = allFloats(bounds.min_du_px), max_du = allFloats(bounds.max_du_px);
  const Floats min_dv = allFloats(bounds.min_dv_px), max_dv = allFloats(bounds.max_dv_px);
  std::array<int, 32 * kFloatLanes> within;
  std::size_t count = 0;
  const auto addAll = [&] {
    for (const int place : std::span(within).first(count)) best.add(place);
    count = 0;
  };
  const Eigen::Vector2f first(bounds.min_du_px, bounds.min_dv_px), last(bounds.max_du_px, bounds.max_dv_px);
  grid_.forEachRangeNear(point_px + first, point_px + last, [&](int begin, int end) {
    for (int i = begin; i < end; i += kFloatLanes) {
      const Floats du = loadFloats(us_px_.data() + i) - u, dv = loadFloats(vs_px_.data() + i) - v;
      const unsigned inside = bitsOf((du >= min_du) & (du <= max_du) & (dv >= min_dv) & (dv <= max_dv)) &
                              ((1U << std::min(end - i, kFloatLanes)) - 1);
      for (int k = 0; k < kFloatLanes; ++k) {
        within[count] = i + k;
        count += inside >> k & 1;
      }
      if (count > within.size() - kFloatLanes) addAll();
    }
  });
  addAll();
}

void CornerLookup::addSimilar(const Signature& look, const Eigen::Vector2f& point_px, const ShiftBounds& bounds,
                              double max_difference, Guesses& guesses) const {
  TwoMostSimilar best(*this, look, max_difference);
  addWithin(point_px, bounds, best);
  best.addTo(guesses, point_px);
}

}  // namespace motorcade
