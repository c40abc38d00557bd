#include "frontend/matching/half_occlusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

constexpr float kReachAcross_px = 120, kReachDown_px = 40;  // to corners of the same surface
constexpr float kNearer = 1.25F;                            // least ratio of a nearer surface's disparity
constexpr float kWholePixel_px = 3;                         // by which a match to a whole pixel may be too small
constexpr float kHalfWindow_px = 6;                         // of a patch, which the right image must show

struct Neighbor {
  float distance_px = std::numeric_limits<float>::max();
  bool hides = false;
};

bool leavesRightImage(float u_px, float disparity_px) { return u_px - disparity_px < kHalfWindow_px; }

/// True when at least two of the three nearest matched corners to the right of corner i show that it must be hidden.
/// `matched` holds all matched corners within reach, in ascending order.
bool isHalfOccluded(std::size_t i, std::span<const std::size_t> matched, const std::vector<Corner>& corners,
                    const std::vector<std::optional<StereoMatch>>& of_corner) {
  const Corner& here = corners[i];
  std::array<Neighbor, 3> nearest;
  for (const std::size_t k : matched) {
    const float du = corners[k].u_px - here.u_px, dv = corners[k].v_px - here.v_px;
    if (k == i || du < 0 || du > kReachAcross_px || std::abs(dv) > kReachDown_px) continue;
    const float distance_px = hypotenuse(du, dv), disparity_px = of_corner[k]->disparity_px;
    if (distance_px >= nearest.back().distance_px) continue;
    const bool is_nearer = disparity_px > kNearer * of_corner[i]->disparity_px;
    nearest.back() = {distance_px, is_nearer && leavesRightImage(here.u_px, disparity_px)};
    std::ranges::sort(nearest, {}, &Neighbor::distance_px);
  }
  return std::ranges::count(nearest, true, &Neighbor::hides) >= 2;
}

}  // namespace

float greatestDisparity_px(const std::vector<std::optional<StereoMatch>>& of_corner) {
  float greatest_px = 0;
  for (const auto& match : of_corner) greatest_px = std::max(greatest_px, match ? match->disparity_px : 0);
  return greatest_px + kWholePixel_px;
}

bool decidesHalfOcclusion(const Corner& corner, float greatest_disparity_px) {
  return leavesRightImage(corner.u_px - kReachAcross_px - 1, greatest_disparity_px);
}

void dropHalfOccluded(const std::vector<Corner>& corners, std::vector<std::optional<StereoMatch>>& of_corner) {
  const float greatest_px = greatestDisparity_px(of_corner);
  std::vector<std::size_t> matched, half_occluded;
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (of_corner[i] && decidesHalfOcclusion(corners[i], greatest_px)) matched.push_back(i);
  for (const std::size_t i : matched)
    if (leavesRightImage(corners[i].u_px, greatest_px) && isHalfOccluded(i, matched, corners, of_corner))
      half_occluded.push_back(i);
  for (const std::size_t i : half_occluded) of_corner[i].reset();
}

}  // namespace motorcade
