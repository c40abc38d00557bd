#include "frontend/matching/neighbor_shifts.hpp"

#include <algorithm>
#include <limits>

namespace motorcade {
namespace {

float median(float a, float b, float c) { return std::max(std::min(a, b), std::min(std::max(a, b), c)); }

}  // namespace

NeighborShifts::NeighborShifts(std::vector<MovedPoint> moved, int width, int height)
    : moved_(std::move(moved)), grid_(moved_, width, height, [](const MovedPoint& point) { return point.from_px; }) {}

std::optional<Shift> NeighborShifts::medianAround(const Eigen::Vector2f& from_px) const {
  if (moved_.size() < 3) return std::nullopt;
  for (float reach_px = 1.5F * PointGrid::kCell_px;; reach_px *= 2) {
    const auto nearest = nearestThree(from_px, reach_px);
    const bool nearer_ones_beyond_reach = nearest.back().first > reach_px * reach_px && reach_px < grid_.extent_px();
    if (nearer_ones_beyond_reach) continue;
    const auto shift = [&](int i) -> const Shift& { return moved_[nearest[i].second].shift; };
    return Shift{median(shift(0).du_px, shift(1).du_px, shift(2).du_px),
                 median(shift(0).dv_px, shift(1).dv_px, shift(2).dv_px)};
  }
}

std::array<NeighborShifts::Neighbor, 3> NeighborShifts::nearestThree(const Eigen::Vector2f& from_px,
                                                                     float reach_px) const {
  std::array<Neighbor, 3> nearest;
  nearest.fill({std::numeric_limits<float>::max(), -1});
  const Eigen::Vector2f reach(reach_px, reach_px);
  grid_.forEachNear(from_px - reach, from_px + reach, [&](int i) {
    const Neighbor candidate((moved_[i].from_px - from_px).squaredNorm(), i);
    if (candidate >= nearest.back()) return;
    nearest.back() = candidate;
    for (std::size_t k = nearest.size() - 1; k > 0 && nearest[k] < nearest[k - 1]; --k)
      std::swap(nearest[k], nearest[k - 1]);
  });
  return nearest;
}

}  // namespace motorcade
