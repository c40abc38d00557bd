#include "apps/synth/bvh.hpp"

#include <array>
#include <numeric>
#include <optional>

namespace motorcade::synth {
namespace {

constexpr int kBins = 12;
constexpr std::uint32_t kLeafItems = 2;
constexpr std::uint32_t kDepthFirstLimit = 1U << 20;  // scenes stay far below: the stack of a traversal holds 64 nodes

struct Split {
  int axis = 0;
  float position = 0;
};

float centre(const Bounds& box, int axis) { return 0.5F * (box.lo[axis] + box.hi[axis]); }

/// The cheapest of the bin borders along the widest axis.
std::optional<Split> bestSplit(const std::uint32_t* items, std::uint32_t count, const std::vector<Bounds>& boxes) {
  Bounds centres;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Bounds& box = boxes[items[i]];
    const Vec3 c = (box.lo + box.hi) * 0.5F;
    centres.include({c, c});
  }
  const Vec3 extent = centres.hi - centres.lo;
  const int axis = extent.x > extent.y ? (extent.x > extent.z ? 0 : 2) : (extent.y > extent.z ? 1 : 2);
  if (extent[axis] < 1e-6F) return std::nullopt;

  std::array<Bounds, kBins> bins;
  std::array<int, kBins> counts{};
  for (std::uint32_t i = 0; i < count; ++i) {
    const Bounds& box = boxes[items[i]];
    const auto bin = static_cast<std::size_t>(std::min(kBins - 1.0F, kBins * (centre(box, axis) - centres.lo[axis]) / extent[axis]));
    bins[bin].include(box);
    ++counts[bin];
  }
  std::optional<Split> best;
  float best_cost = 1e30F;
  for (std::size_t border = 1; border < kBins; ++border) {
    Bounds left, right;
    int left_count = 0, right_count = 0;
    for (std::size_t b = 0; b < kBins; ++b) {
      if (counts[b] == 0) continue;
      (b < border ? left : right).include(bins[b]);
      (b < border ? left_count : right_count) += counts[b];
    }
    if (left_count == 0 || right_count == 0) continue;
    const float cost = left.area() * static_cast<float>(left_count) + right.area() * static_cast<float>(right_count);
    if (cost < best_cost) {
      best_cost = cost;
      best = Split{axis, centres.lo[axis] + extent[axis] * static_cast<float>(border) / kBins};
    }
  }
  return best;
}

}  // namespace

Bvh::Bvh(const std::vector<Bounds>& boxes) : items_(boxes.size()) {
  if (boxes.empty() || boxes.size() > kDepthFirstLimit) return;
  std::iota(items_.begin(), items_.end(), 0U);
  nodes_.reserve(2 * boxes.size());
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(boxes.size()), boxes);
}

void Bvh::build(std::uint32_t node, std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& boxes) {
  Bounds all;
  for (std::uint32_t i = 0; i < count; ++i) all.include(boxes[items_[first + i]]);
  nodes_[node].lo = all.lo;
  nodes_[node].hi = all.hi;
  const auto split = count > kLeafItems ? bestSplit(items_.data() + first, count, boxes) : std::nullopt;
  if (!split) {
    nodes_[node].first = first;
    nodes_[node].count = count;
    return;
  }
  const auto begin = items_.begin() + first;
  const auto middle = std::stable_partition(begin, begin + count, [&](std::uint32_t i) { return centre(boxes[i], split->axis) < split->position; });
  auto left = static_cast<std::uint32_t>(middle - begin);
  if (left == 0 || left == count) left = count / 2;
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = children;
  nodes_[node].count = 0;
  build(children, first, left, boxes);
  build(children + 1, first + left, count - left, boxes);
}

}  // namespace motorcade::synth
