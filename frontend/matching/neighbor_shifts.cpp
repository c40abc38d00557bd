#include "frontend/matching/neighbor_shifts.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "frontend/matching/corner_lookup.hpp"

namespace motorcade {
namespace {

float median(float a, float b, float c) { return std::max(std::min(a, b), std::min(std::max(a, b), c)); }

constexpr int kIndexBits = 32;

}  // namespace

float NeighborShifts::Neighbor::squared_px() const {
  return std::bit_cast<float>(static_cast<std::int32_t>(key >> kIndexBits));
}

int NeighborShifts::Neighbor::index() const { return static_cast<int>(key & INT32_MAX); }

NeighborShifts::NeighborShifts(std::vector<MovedPoint> moved, int width, int height)
    : moved_(std::move(moved)), grid_(moved_, width, height, [](const MovedPoint& point) { return point.from_px; }) {
  places_.reserve(moved_.size());
  for (const int i : grid_.byPlace()) places_.push_back({moved_[i].from_px.x(), moved_[i].from_px.y(), i});
}

std::optional<Shift> NeighborShifts::medianAround(const Eigen::Vector2f& from_px) const {
  if (moved_.size() < 3) return std::nullopt;
  for (float reach_px = 1.5F * PointGrid::kCell_px;; reach_px *= 2) {
    const auto nearest = nearestThree(from_px, reach_px);
    const bool nearer_ones_beyond_reach =
        nearest.back().squared_px() > reach_px * reach_px && reach_px < grid_.extent_px();
    if (nearer_ones_beyond_reach) continue;
    const auto shift = [&](int i) -> const Shift& { return moved_[nearest[i].index()].shift; };
    return Shift{median(shift(0).du_px, shift(1).du_px, shift(2).du_px),
                 median(shift(0).dv_px, shift(1).dv_px, shift(2).dv_px)};
  }
}

/// Finds the nearest three points without branches, as which point is nearer than others is unforeseeable.
std::array<NeighborShifts::Neighbor, 3> NeighborShifts::nearestThree(const Eigen::Vector2f& from_px,
                                                                     float reach_px) const {
  const auto bits = [](float x) { return std::int64_t{std::bit_cast<std::int32_t>(x)} << kIndexBits; };
  const std::int64_t none = bits(std::numeric_limits<float>::max());
  std::int64_t first = none, second = none, third = none;
  const Eigen::Vector2f reach(reach_px, reach_px);
  grid_.forEachRangeNear(from_px - reach, from_px + reach, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const Place& place = places_[i];
      const float du = place.u_px - from_px.x(), dv = place.v_px - from_px.y();
      const std::int64_t candidate = bits(du * du + dv * dv) | place.index;
      third = lesser(third, greater(second, candidate));
      second = lesser(second, greater(first, candidate));
      first = lesser(first, candidate);
    }
  });
  return {Neighbor{first}, Neighbor{second}, Neighbor{third}};
}

}  // namespace motorcade
