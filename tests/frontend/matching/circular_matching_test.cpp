#include "frontend/matching/circular_matching.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/two_surfaces.hpp"

namespace motorcade {
namespace {

using test::TwoSurfaces;

constexpr int kPoints = TwoSurfaces::kWallPoints + TwoSurfaces::kCarPoints;

ExpectedDisparities nothingExpected() {
  return {.of_point = std::vector<std::optional<ExpectedDisparity>>(kPoints), .motion_known = false, .offset_px = 0};
}

/// Disparities expected by the truth of the frame before and of the camera's motion.
ExpectedDisparities expectedIn(const TwoSurfaces& scene, int frame) {
  ExpectedDisparities expected = nothingExpected();
  expected.motion_known = true;
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d at_rest = scene.p_cam({i}, frame - 1) - Eigen::Vector3d(0, 0, TwoSurfaces::kCameraStep_m);
    expected.of_point[i] = {.before_px = scene.uvd_px({i}, frame - 1).z(),
                            .at_rest_px = test::kSmallRig.project(at_rest)->z()};
  }
  return expected;
}

/// Observed points of the car or the wall whose disparity is right.
int rightOnes(const TwoSurfaces& scene, int frame, bool on_car,
              const std::vector<std::optional<StereoObservation>>& observed) {
  int right = 0;
  for (int i = 0; i < kPoints; ++i)
    right += scene.onCar({i}) == on_car && observed[i] &&
             std::abs(observed[i]->uvd_px.z() - scene.uvd_px({i}, frame).z()) < 0.5;
  return right;
}

/// Cars overtake a camera at 10 m/s at 20 m/s, and fall back at 5 m/s.
TEST(CircularMatching, FindsTheDisparityOfANearVehicleWhateverItsSpeed) {
  const CircularMatching match({}, test::kSmallRig);
  for (const double car_step_m : {2.0, 0.5}) {
    const TwoSurfaces scene(car_step_m);
    const auto stereo = scene.stereo(1);
    const auto observed = match(*stereo, *scene.flow(*stereo, 1), expectedIn(scene, 1));
    EXPECT_GE(rightOnes(scene, 1, true, observed), 10) << "car moves " << car_step_m << " m";
    EXPECT_GE(rightOnes(scene, 1, false, observed), 140);
  }
}

TEST(CircularMatching, ANewPointHasTheDisparityOfItsCornerAndTheOffset) {
  const CircularMatching match({}, test::kSmallRig);
  const TwoSurfaces scene(1);
  const auto stereo = scene.stereo(0);
  auto expected = nothingExpected();
  expected.offset_px = 0.25;
  const auto observed = match(*stereo, *scene.flow(*stereo, 0), expected);
  ASSERT_EQ(observed.size(), kPoints);
  for (int i = 0; i < kPoints; ++i) {
    ASSERT_TRUE(observed[i]);
    EXPECT_EQ(observed[i]->uvd_px.z(), stereo->of_corner[i]->disparity_px + 0.25F);
  }
}

TEST(CircularMatching, WhereItsCornerHasNoneANeighborTellsWhereToLook) {
  const CircularMatching match({}, test::kSmallRig);
  const TwoSurfaces scene(1);
  StereoMatches every_other = *scene.stereo(0);
  for (int i = 0; i < kPoints; i += 2) every_other.of_corner[i].reset();
  const auto observed = match(every_other, *scene.flow(every_other, 0), nothingExpected());
  EXPECT_GE(rightOnes(scene, 0, true, observed), 10);
  EXPECT_GT(rightOnes(scene, 0, false, observed), TwoSurfaces::kWallPoints / 2);
  every_other.of_corner.assign(kPoints, std::nullopt);
  for (const auto& o : match(every_other, *scene.flow(every_other, 0), nothingExpected())) EXPECT_FALSE(o);
}

TEST(CircularMatching, WhatTheRightImageDoesNotShowIsNotObserved) {
  const CircularMatching match({}, test::kSmallRig);
  const TwoSurfaces scene(1);
  auto stereo = *scene.stereo(1);
  auto features = std::make_shared<Features>(*stereo.features);
  features->right.levels.front() = test::render(test::kSmallRig.width_px, test::kSmallRig.height_px, test::Texture(9));
  stereo.features = features;
  const auto observed = match(stereo, *scene.flow(stereo, 1), expectedIn(scene, 1));
  EXPECT_LE(std::ranges::count_if(observed, [](const auto& o) { return o.has_value(); }), kPoints / 5)
      << "smooth textures are alike by chance";
}

TEST(CircularMatching, StandardDeviationsAreNeverBelowTheirFloor) {
  CircularMatching::Params params;
  params.sigma_flow_px = 0.5;
  params.sigma_disparity_px = 0.75;
  const CircularMatching match(params, test::kSmallRig);
  const TwoSurfaces scene(1);
  const auto stereo = scene.stereo(1);
  for (const auto& o : match(*stereo, *scene.flow(*stereo, 1), expectedIn(scene, 1))) {
    if (!o) continue;
    EXPECT_EQ(o->sigma_px.x(), 0.5F);
    EXPECT_EQ(o->sigma_px.y(), 0.5F);
    EXPECT_GE(o->sigma_px.z(), 0.75F);
  }
}

}  // namespace
}  // namespace motorcade
