#include "frontend/matching/half_occlusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace motorcade {
namespace {

constexpr float kReachAcross_px = 120, kReachDown_px = 40;  // to corners of the same surface
constexpr float kNearer = 1.25F;                            // least ratio of a nearer surface's disparity
constexpr float kWholePixel_px = 3;                         // by which a match to a whole pixel may be too small
constexpr float kHalfPatch_px = 6;                          // of a patch, which the right image must show

struct MatchedCorner {
  std::size_t corner;
  float u_px, v_px, disparity_px;
};

struct Neighbor {
  float distance_px2 = std::numeric_limits<float>::max();
  bool hides = false;
};

bool leavesRightImage(float u_px, float disparity_px) { return u_px - disparity_px < kHalfPatch_px; }

/// True when at least two of the three nearest matched corners to the right show that it must be hidden. `matched`
/// holds all matched corners within reach, and this one.
bool isHalfOccluded(const MatchedCorner& here, std::span<const MatchedCorner> matched) {
  std::array<Neighbor, 3> nearest;
  for (const MatchedCorner& other : matched) {
    const float du = other.u_px - here.u_px, dv = other.v_px - here.v_px, distance_px2 = du * du + dv * dv;
    const float aside_px = std::abs(dv);
    // One branch, hardly ever taken: which corners are near is unforeseeable.
    const bool near = (du >= 0) & (du <= kReachAcross_px) & (aside_px <= kReachDown_px) &
                      (distance_px2 < nearest.back().distance_px2);
    if (!near || &other == &here) continue;
    const bool is_nearer = other.disparity_px > kNearer * here.disparity_px;
    nearest.back() = {distance_px2, is_nearer && leavesRightImage(here.u_px, other.disparity_px)};
    std::ranges::sort(nearest, {}, &Neighbor::distance_px2);
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
  std::vector<MatchedCorner> matched;
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (of_corner[i] && decidesHalfOcclusion(corners[i], greatest_px))
      matched.push_back({i, corners[i].u_px, corners[i].v_px, of_corner[i]->disparity_px});
  for (const MatchedCorner& corner : matched)
    if (leavesRightImage(corner.u_px, greatest_px) && isHalfOccluded(corner, matched)) of_corner[corner.corner].reset();
}

}  // namespace motorcade
