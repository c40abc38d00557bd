#include "frontend/matching/corner_lookup.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/word_lanes.hpp"

namespace motorcade {
namespace {

using WordBytes = std::uint8_t __attribute__((vector_size(kWordLanes)));

}  // namespace

Signature::Signature(const ImagePyramid& pyramid, float u_px, float v_px) {
  const int last_level = static_cast<int>(pyramid.levels.size()) - 1;
  for (int level = 0; level < 2; ++level) {
    const Image& image = pyramid.levels[std::min(level, last_level)];
    const int x = std::clamp(static_cast<int>(std::lround(toLevel(u_px, level))) - kSide / 2, 0, image.width() - kSide);
    const int y =
        std::clamp(static_cast<int>(std::lround(toLevel(v_px, level))) - kSide / 2, 0, image.height() - kSide);
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
  for (int r = 0; r < kSide; ++r) std::memcpy(out + r * kSide, image.row(y + r) + x, kSide);
  std::array<Words, kSide / 2> pixels;
  Words sums{};
  for (int i = 0; i < kSide / 2; ++i) sums += pixels[i] = wordPixels(out + i * kWordLanes);
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

CornerLookup::CornerLookup(const Features& features)
    : grid_(features.corners, features.left.levels.front().width(), features.left.levels.front().height(),
            [](const Corner& c) { return Eigen::Vector2f(c.u_px, c.v_px); }) {
  positions_.reserve(features.corners.size());
  signatures_.reserve(features.corners.size());
  for (const Corner& corner : features.corners) {
    positions_.emplace_back(corner.u_px, corner.v_px);
    signatures_.emplace_back(features.left, corner.u_px, corner.v_px);
  }
}

void CornerLookup::addSimilar(const ImagePyramid& from, const FlowObservation& point, const ShiftBounds& bounds,
                              double max_difference, Guesses& guesses) const {
  const Signature signature(from, point.u_px, point.v_px);
  const Eigen::Vector2f here(point.u_px, point.v_px);
  const std::pair none(static_cast<int>(max_difference * Signature::kPixels), -1);
  std::array best{none, none};  // the smallest difference first; of equal ones the corner with the smaller index
  const Eigen::Vector2f first(bounds.min_du_px, bounds.min_dv_px), last(bounds.max_du_px, bounds.max_dv_px);
  grid_.forEachNear(here + first, here + last, [&](int i) {
    const Eigen::Vector2f shift = positions_[i] - here;
    if (!bounds.contain(shift.x(), shift.y())) return;
    const std::pair candidate(signature.distance(signatures_[i]), i);
    if (candidate >= best[1]) return;
    best[1] = candidate;
    if (best[1] < best[0]) std::swap(best[0], best[1]);
  });
  for (const auto& [distance, i] : best) {
    if (i < 0) continue;
    const Eigen::Vector2f shift = positions_[i] - here;
    guesses.add({shift.x(), shift.y()});
  }
}

}  // namespace motorcade
