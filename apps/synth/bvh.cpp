#include "apps/synth/bvh.hpp"

#include <array>
#include <numeric>
#include <optional>

namespace motorcade::synth {
namespace {

constexpr int kBins = 12;

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
  if (boxes.empty()) return;
  std::iota(items_.begin(), items_.end(), 0U);
  nodes_.reserve(boxes.size());
  build(0, static_cast<std::uint32_t>(boxes.size()), boxes);
}

/// Reorders a range in two parts; the size of the first one.
std::uint32_t Bvh::split(std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& boxes) {
  const auto best = bestSplit(items_.data() + first, count, boxes);
  if (!best) return count / 2;
  const auto begin = items_.begin() + first;
  const auto middle =
      std::stable_partition(begin, begin + count, [&](std::uint32_t i) { return centre(boxes[i], best->axis) < best->position; });
  const auto left = static_cast<std::uint32_t>(middle - begin);
  return left == 0 || left == count ? count / 2 : left;
}

std::uint32_t Bvh::build(std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& boxes) {
  struct Range {
    std::uint32_t first, count;
  };
  std::vector<Range> children{{first, count}};
  while (children.size() < 4) {
    const auto largest =
        std::max_element(children.begin(), children.end(), [](const Range& a, const Range& b) { return a.count < b.count; });
    if (largest->count < 2) break;
    const std::uint32_t left = split(largest->first, largest->count, boxes);
    const Range rest{largest->first + left, largest->count - left};
    largest->count = left;
    children.push_back(rest);
  }
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  for (std::size_t i = 0; i < 4; ++i) {
    Bounds all;
    if (i < children.size())
      for (std::uint32_t k = 0; k < children[i].count; ++k) all.include(boxes[items_[children[i].first + k]]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      nodes_[index].lo[axis][i] = all.lo[static_cast<int>(axis)];
      nodes_[index].hi[axis][i] = all.hi[static_cast<int>(axis)];
    }
  }
  for (std::size_t i = 0; i < children.size(); ++i) {
    const std::uint32_t child =
        children[i].count == 1 ? kLeaf | items_[children[i].first] : build(children[i].first, children[i].count, boxes);
    nodes_[index].child[i] = child;
  }
  return index;
}

}  // namespace motorcade::synth
