#include "frontend/shape/dense_disparity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "frontend/image/byte_lanes.hpp"
#include "frontend/shape/parabola.hpp"

namespace motorcade {
namespace {

// Costs are Hamming distances. With the cost of the cheapest way to a pixel taken off, a path's cost never exceeds
// Census::kMostDifferent + kJump, and the sum over four directions fits a byte.
constexpr std::uint8_t kUnknownCost = 12;  // of a pixel without counterpart: as of one picked at random
constexpr std::uint8_t kStep = 5;          // penalty for a change of the disparity by one, along a path
constexpr std::uint8_t kJump = 22;         // and for a greater one
constexpr std::uint8_t kFar = 200;         // of a path: more than any sum of costs, and a step from an overflow
static_assert(4 * (Census::kMostDifferent + kJump) < kFar && kFar + kStep <= UINT8_MAX);
constexpr int kMostDisparities = kFar;
constexpr int kMaxRoundTrip_px = 1;
constexpr int kLeastTexture = 10;  // gray levels between the brightest and the darkest of a 5x5 window: without
                                   // texture, a disparity is but its neighbors'

constexpr Bytes kEveryLane{0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                           16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};

/// The place of the least of a pixel's sums; the first of several.
int leastIn(const std::uint8_t* sums, std::size_t lanes) {
  Bytes least_of_lanes = loadBytes(sums);
  for (std::size_t i = kByteLanes; i < lanes; i += kByteLanes)
    least_of_lanes = lesser(least_of_lanes, loadBytes(sums + i));
  const std::uint8_t least = leastOf(least_of_lanes);
  for (std::size_t i = 0; i < lanes; i += kByteLanes)
    if (const int lane = firstOf(loadBytes(sums + i), least); lane < kByteLanes) return static_cast<int>(i) + lane;
  return 0;
}

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
  lanes_ = static_cast<std::size_t>(range.count + kByteLanes - 1) / kByteLanes * kByteLanes;
  beyond_.assign(lanes_, 0);
  std::fill(beyond_.begin() + range.count, beyond_.end(), kFar);
  left_.compute(left, window, false, 0);
  right_.compute(right, {right_u0_, window.v0, right_width_, window.height}, true,
                 window.width + static_cast<int>(lanes_));
  fillCosts();
  aggregate();
  choose(map);
  return map;
}

void DenseDisparity::fillCosts() {
  costs_.resize(static_cast<std::size_t>(window_.area()) * lanes_);
  std::uint8_t* costs = costs_.data();
  for (int row = 0; row < window_.height; ++row) {
    for (int column = 0; column < window_.width; ++column, costs += lanes_) {
      for (std::size_t i = 0; i < lanes_; i += kByteLanes) {
        Bytes different{};
        for (int byte = 0; byte < Census::kBytes; ++byte) {
          const std::uint8_t* right = right_.row(byte, row) + inRight(column) + static_cast<std::ptrdiff_t>(i);
          different += bitCounts(loadBytes(right) ^ allBytes(left_.row(byte, row)[column]));
        }
        storeBytes(costs + i, different);
      }
      const int first = -inRight(column), end = right_width_ - inRight(column);  // of the disparities in the image
      for (int i = 0; i < std::min(first, range_.count); ++i) costs[i] = kUnknownCost;
      for (int i = std::max(end, 0); i < range_.count; ++i) costs[i] = kUnknownCost;
    }
  }
}

void DenseDisparity::aggregate() {
  const int width = window_.width, height = window_.height, last = width * height - 1;
  sums_.assign(costs_.size(), 0);
  sumAlong({.count = height, .steps = width, .first = 0, .between_paths = width, .between_steps = 1});
  sumAlong({.count = height, .steps = width, .first = last, .between_paths = -width, .between_steps = -1});
  sumAlong({.count = width, .steps = height, .first = 0, .between_paths = 1, .between_steps = width});
  sumAlong({.count = width, .steps = height, .first = last, .between_paths = -1, .between_steps = -width});
}

void DenseDisparity::sumAlong(const Paths& paths) {
  const std::size_t stride = lanes_ + kByteLanes;  // kFar before its first disparity and after its last
  paths_.assign(paths.count * stride + kByteLanes, kFar);
  least_of_path_.assign(paths.count, 0);
  for (int i = 0; i < paths.count; ++i) std::ranges::copy(beyond_, paths_.data() + i * stride + kByteLanes);
  for (int step = 0; step < paths.steps; ++step) {
    std::ptrdiff_t pixel = paths.first + step * paths.between_steps;
    for (int i = 0; i < paths.count; ++i, pixel += paths.between_paths)
      stepAlongPath(paths_.data() + i * stride + kByteLanes, &least_of_path_[i], static_cast<std::size_t>(pixel));
  }
}

/// The cost of each disparity with the cheapest way to get there from the pixel before.
void DenseDisparity::stepAlongPath(std::uint8_t* path, std::uint8_t* least, std::size_t pixel) {
  const std::uint8_t* costs = costs_.data() + pixel * lanes_;
  std::uint8_t* sums = sums_.data() + pixel * lanes_;
  const Bytes jump = allBytes(static_cast<std::uint8_t>(*least + kJump)), taken_off = allBytes(*least);
  Bytes below = loadBytes(path - 1), least_yet = allBytes(kFar);
  for (std::size_t i = 0; i < lanes_; i += kByteLanes) {
    const Bytes same = loadBytes(path + i), above = loadBytes(path + i + 1);
    const Bytes step = lesser(below, above) + kStep, way = lesser(lesser(same, step), jump);
    below = loadBytes(path + i + kByteLanes - 1);
    const Bytes next = greater(loadBytes(costs + i) + way - taken_off, loadBytes(beyond_.data() + i));
    storeBytes(path + i, next);
    storeBytes(sums + i, loadBytes(sums + i) + next);
    least_yet = lesser(least_yet, next);
  }
  *least = leastOf(least_yet);
}

/// Of each row, the disparity of each column of the right image that has the least sum.
void DenseDisparity::chooseOfRight(int row) {
  const std::size_t room = window_.width + lanes_;
  least_of_right_.assign(right_width_ + 2 * room, UINT8_MAX);
  best_of_right_.resize(least_of_right_.size());
  const std::uint8_t* sums = sums_.data() + static_cast<std::size_t>(row) * window_.width * lanes_;
  for (int column = 0; column < window_.width; ++column) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(room) + inRight(column);
    for (std::size_t i = 0; i < lanes_; i += kByteLanes, sums += kByteLanes) {
      std::uint8_t *least = least_of_right_.data() + at + i, *best = best_of_right_.data() + at + i;
      const Bytes here = loadBytes(sums), before = loadBytes(least);
      const Bytes less = Bytes(here < before);
      storeBytes(least, lesser(here, before));
      storeBytes(best, (less & (kEveryLane + allBytes(static_cast<std::uint8_t>(i)))) | (~less & loadBytes(best)));
    }
  }
}

void DenseDisparity::choose(DisparityMap& map) {
  const std::ptrdiff_t room = window_.width + static_cast<std::ptrdiff_t>(lanes_);
  std::uint8_t* sums = sums_.data();
  for (std::size_t i = 0; i < sums_.size(); i += kByteLanes)
    storeBytes(sums + i, greater(loadBytes(sums + i), loadBytes(beyond_.data() + i % lanes_)));
  for (int row = 0; row < window_.height; ++row) {
    chooseOfRight(row);
    for (int column = 0; column < window_.width; ++column, sums += lanes_) {
      if (left_.texture(row)[column] < kLeastTexture) continue;
      const int best = leastIn(sums, lanes_), at = inRight(column) + best;
      if (at < 0 || at >= right_width_ || std::abs(best_of_right_[room + at] - best) > kMaxRoundTrip_px) continue;
      const bool inside = best > 0 && best + 1 < range_.count;
      const float offset = inside ? parabolaOffset(sums[best - 1], sums[best], sums[best + 1]) : 0.0F;
      map.disparity_px[static_cast<std::size_t>(row) * window_.width + column] =
          static_cast<float>(range_.least_px + best) + offset;
    }
  }
}

}  // namespace motorcade
