#include "frontend/shape/dense_disparity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/shape/dense_disparity.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

/// Of kByteLanes pixels, the disparity of the least sum; the first of several. The sums of each disparity are `stride`
/// after those of the one before.
Bytes bestOf(const std::uint8_t* sums, std::ptrdiff_t stride, int disparities) {
  Bytes least = load(sums), best{}, disparity{};
  for (int d = 1; d < disparities; ++d) {
    sums += stride, disparity += 1;
    const Bytes less = lesser(load(sums), least);
    best = choose(less == least, best, disparity);
    least = less;
  }
  return best;
}

}  // namespace

using CensusBytes = std::array<const std::uint8_t*, Census::kBytes>;

/// Hamming distances of kByteLanes pixels to those of the right image, which are one pixel to the left for each
/// disparity.
void compareBlock(const CensusBytes& left, CensusBytes right, int disparities, std::uint8_t* costs) {
  std::array<Bytes, Census::kBytes> of_left;
  for (int byte = 0; byte < Census::kBytes; ++byte) of_left[byte] = load(left[byte]);
  for (int d = 0; d < disparities; ++d, costs += kByteLanes) {
    Bytes different{};
    for (int byte = 0; byte < Census::kBytes; ++byte) different += bitCounts(load(right[byte]--) ^ of_left[byte]);
    store(costs, different);
  }
}

/// The best disparities of a row.
void bestOfRow(const std::uint8_t* sums, std::ptrdiff_t stride, int disparities, int width, std::uint8_t* best) {
  for (int column = 0; column < width; column += kByteLanes)
    store(best + column, bestOf(sums + column, stride, disparities));
}

/// Copies the sums of a block, each disparity to a row of its own.
void gatherBlock(const std::uint8_t* sums, const std::uint8_t* beyond, int disparities, std::uint8_t* out,
                 std::ptrdiff_t stride) {
  const Bytes bits = load(beyond);
  for (int d = 0; d < disparities; ++d) store(out + d * stride, load(sums + d * kByteLanes) | bits);
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(compareBlock);
MOTORCADE_EXPORT(bestOfRow);
MOTORCADE_EXPORT(gatherBlock);

namespace {

constexpr int kByteLanes = DisparityBlocks::kBlock;

static_assert(Census::kMostDifferent <= PathCosts::kMostCost);
constexpr std::uint8_t kUnknownCost = 12;  // of a pixel without counterpart: as of one picked at random
constexpr int kMostDisparities = 200;      // whose numbers fit a byte
constexpr int kMaxRoundTrip_px = 1;
constexpr int kLeastTexture = 10;  // gray levels between the brightest and the darkest of a 5x5 window: without
                                   // texture, a disparity is but its neighbors'

}  // namespace

DisparityMap DenseDisparity::operator()(const Image& left, const Image& right, PixelWindow window, Range range) {
  const int u_end = std::min(window.u0 + window.width, left.width()),
            v_end = std::min(window.v0 + window.height, left.height());
  window.u0 = std::max(window.u0, 0), window.v0 = std::max(window.v0, 0);
  window.width = u_end - window.u0, window.height = v_end - window.v0;
  range.count = std::min(range.count + std::min(range.least_px, 0), kMostDisparities);
  range.least_px = std::max(range.least_px, 0);
  DisparityMap map{.window = window, .disparity_px = {}};
  if (window.empty() || range.count <= 0) return {};
  map.disparity_px.assign(static_cast<std::size_t>(window.area()), DisparityMap::kNone);

  window_ = window, range_ = range;
  right_u0_ = std::max(0, window.u0 - range.least_px - range.count + 1);
  right_width_ = std::min(u_end - range.least_px, right.width()) - right_u0_;
  if (right_width_ <= 0) return map;
  left_.compute(left, window, kByteLanes);
  right_.compute(right, {right_u0_, window.v0, right_width_, window.height}, window.width + range.count + kByteLanes);
  fillCosts();
  path_costs_.sum(costs_, sums_);
  room_ = range.count + kByteLanes;
  stride_of_sums_ = costs_.blocks() * kByteLanes + 2 * room_;
  sums_of_row_.assign(static_cast<std::size_t>(stride_of_sums_) * range.count, UINT8_MAX);
  beyond_.assign(static_cast<std::size_t>(costs_.blocks()) * kByteLanes, 0);
  std::fill(beyond_.begin() + window.width, beyond_.end(), UINT8_MAX);
  for (int row = 0; row < window.height; ++row) choose(row, map);
  return map;
}

void DenseDisparity::fillCosts() {
  costs_.resize(window_.height, window_.width, range_.count);
  const auto compare = MOTORCADE_KERNEL(compareBlock);
  for (int row = 0; row < window_.height; ++row) {
    for (int block = 0; block < costs_.blocks(); ++block) {
      std::array<const std::uint8_t*, Census::kBytes> left, right;
      for (int byte = 0; byte < Census::kBytes; ++byte) {
        left[byte] = left_.row(byte, row) + block * kByteLanes;
        right[byte] = right_.row(byte, row) + inRight(block * kByteLanes);
      }
      compare(left, right, range_.count, costs_.at(row, block));
    }
    for (int d = 0; d < range_.count; ++d) markUnknown(costs_.at(row, 0), d);
  }
}

/// Where the right image has no counterpart.
void DenseDisparity::markUnknown(std::uint8_t* costs_of_row, int disparity) const {
  const auto mark = [&](int column) {
    const int block = column / kByteLanes, lane = column % kByteLanes;
    costs_of_row[(block * range_.count + disparity) * kByteLanes + lane] = kUnknownCost;
  };
  for (int column = 0; column < std::min(disparity - inRight(0), window_.width); ++column) mark(column);
  for (int column = std::max(disparity - inRight(0) + right_width_, 0); column < window_.width; ++column) mark(column);
}

/// The disparities of one row that the search from right to left agrees with.
void DenseDisparity::choose(int row, DisparityMap& map) {
  gatherRow(row);
  best_.resize(beyond_.size());
  const auto findBest = MOTORCADE_KERNEL(bestOfRow);
  findBest(sums_of_row_.data() + inSums(0), stride_of_sums_, range_.count, window_.width, best_.data());
  best_of_right_.resize(right_width_ + kByteLanes);
  findBest(sums_of_row_.data() + inSums(0) - inRight(0), stride_of_sums_ + 1, range_.count, right_width_,
           best_of_right_.data());
  const std::uint8_t* texture = left_.texture(row);
  float* disparities_px = map.disparity_px.data() + static_cast<std::size_t>(row) * window_.width;
  for (int column = 0; column < window_.width; ++column) {
    if (texture[column] < kLeastTexture) continue;
    const int best = best_[column], at = inRight(column) - best;
    if (at < 0 || at >= right_width_ || std::abs(best_of_right_[at] - best) > kMaxRoundTrip_px) continue;
    const bool inside = best > 0 && best + 1 < range_.count;
    const std::uint8_t* sum = sums_of_row_.data() + inSums(best) + column;
    const float offset = inside ? parabolaOffset(sum[-stride_of_sums_], sum[0], sum[stride_of_sums_]) : 0.0F;
    disparities_px[column] = static_cast<float>(range_.least_px + best) + offset;
  }
}

/// The sums of a row, which more than any stand around.
void DenseDisparity::gatherRow(int row) {
  const auto gather = MOTORCADE_KERNEL(gatherBlock);
  for (int block = 0; block < sums_.blocks(); ++block)
    gather(sums_.at(row, block), beyond_.data() + block * kByteLanes, range_.count,
           sums_of_row_.data() + inSums(0) + block * kByteLanes, stride_of_sums_);
}

}  // namespace motorcade
#endif
