#include "frontend/matching/half_occlusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace motorcade {
namespace {

constexpr float kReachAcross_px = 120, kReachDown_px = 40, kNearer = 1.25F, kHalfWindow_px = 6;

bool leavesRightImage(float u_px, float disparity_px) { return u_px - disparity_px < kHalfWindow_px; }

}  // namespace

void dropHalfOccluded(const std::vector<Corner>& corners, std::vector<std::optional<StereoMatch>>& of_corner) {
  float greatest_px = 0;
  for (const auto& match : of_corner) greatest_px = std::max(greatest_px, match ? match->disparity_px : 0);
  std::vector<std::size_t> looks_through;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& here = corners[i];
    if (!of_corner[i] || !leavesRightImage(here.u_px, greatest_px)) continue;
    struct Neighbor {
      float distance_px = std::numeric_limits<float>::max();
      bool hides = false;
    };
    std::array<Neighbor, 3> nearest;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const float du = corners[k].u_px - here.u_px, dv = corners[k].v_px - here.v_px;
      if (k == i || !of_corner[k] || du < 0 || du > kReachAcross_px || std::abs(dv) > kReachDown_px) continue;
      const float distance_px = std::hypot(du, dv), disparity_px = of_corner[k]->disparity_px;
      if (distance_px >= nearest.back().distance_px) continue;
      nearest.back() = {distance_px, disparity_px > kNearer * of_corner[i]->disparity_px &&
                                         leavesRightImage(here.u_px, disparity_px)};
      std::ranges::sort(nearest, {}, &Neighbor::distance_px);
    }
    if (std::ranges::count(nearest, true, &Neighbor::hides) >= 2) looks_through.push_back(i);
  }
  for (const std::size_t i : looks_through) of_corner[i].reset();
}

}  // namespace motorcade
