#include "frontend/matching/half_occlusion.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

/// Corners with their disparities.
struct View {
  std::vector<Corner> corners;
  std::vector<std::optional<StereoMatch>> of_corner;
  void add(float u_px, float v_px, std::optional<float> disparity_px) {
    corners.push_back({u_px, v_px, 1});
    of_corner.push_back(disparity_px ? std::optional(StereoMatch{*disparity_px, 0.1F}) : std::nullopt);
  }
  /// The rear of a truck whose left edge is at u = 75.
  void addNearSurface(float disparity_px) {
    for (int i = 0; i < 6; ++i)
      add(85.0F + 12 * static_cast<float>(i % 3), 200.0F + 20 * static_cast<float>(i / 3), disparity_px);
  }
};

TEST(HalfOcclusion, DropsMatchesBehindASurfaceThatLeavesTheRightImage) {
  View view;
  view.addNearSurface(72);
  view.add(60, 205, 40.0F);         // a point of the truck that was matched too far away
  view.add(60, 225, std::nullopt);  // without a match
  dropHalfOccluded(view.corners, view.of_corner);
  EXPECT_FALSE(view.of_corner[6]);
  EXPECT_FALSE(view.of_corner[7]);
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(view.of_corner[i]);
}

TEST(HalfOcclusion, KeepsMatchesThatTheRightImageCouldShow) {
  View view;
  view.addNearSurface(72);
  view.add(79, 205, 70.0F);  // on the surface, just within the right image
  view.add(80, 205, 40.0F);  // behind it, but at a column that the right image shows
  view.add(20, 300, 10.0F);  // on the road, far below it
  dropHalfOccluded(view.corners, view.of_corner);
  for (const auto& match : view.of_corner) EXPECT_TRUE(match);
}

TEST(HalfOcclusion, IgnoresSurfacesToTheLeft) {
  View view;
  for (int i = 0; i < 6; ++i) view.add(10.0F + 4 * static_cast<float>(i), 200, 5.0F);
  view.add(60, 200, 4.0F);
  dropHalfOccluded(view.corners, view.of_corner);
  for (const auto& match : view.of_corner) EXPECT_TRUE(match);
}

}  // namespace
}  // namespace motorcade
