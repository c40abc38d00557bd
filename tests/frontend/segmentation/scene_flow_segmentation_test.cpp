#include "frontend/segmentation/scene_flow_segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/frontend/two_surfaces.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

/// Messages of a frame without a single point.
SceneMotionPtr runEmpty(SceneFlowSegmentation& estimate, int frame, const std::string& problem) {
  auto pair = std::make_shared<StereoFrame>();
  pair->head.frame = {frame};
  pair->head.stamp = {frame * 100'000'000};
  if (!problem.empty()) pair->reject(FrameCause::kUnusable, problem);
  auto features = std::make_shared<Features>();
  features->frame = pair;
  auto stereo = std::make_shared<StereoMatches>();
  stereo->features = features;
  auto flow = std::make_shared<OpticalFlow>();
  flow->features = features;
  return estimate(stereo, flow);
}

TEST(SceneFlowSegmentation, EveryInputGivesOneOutputOfItsFrameAlsoWhenRejectedOrEmpty) {
  SceneFlowSegmentation estimate({}, test::kRig);
  for (int frame = 0; frame < 6; ++frame) {
    const bool rejected = frame == 2 || frame == 3;
    const auto motion = runEmpty(estimate, frame, rejected ? "unreadable" : "");
    ASSERT_TRUE(motion);
    EXPECT_EQ(motion->head.frame, FrameId{frame});
    EXPECT_EQ(motion->head.stamp, Timestamp{frame * 100'000'000});
    EXPECT_EQ(motion->head.status, rejected ? FrameStatus::kRejected : FrameStatus::kLost);
    EXPECT_TRUE(motion->points.empty());
    EXPECT_THAT(motion->odometry.T_previous_now,
                test::IsNearPose(SE3{}, 0.0));  // no motion was ever seen: standing still is predicted
  }
}

/// Optical flow gives new numbers after a rejected frame; this one does not, and the trail has forgotten its frames.
TEST(SceneFlowSegmentation, PointsThatComeBackAfterManyRejectedFramesAreTakenAsNew) {
  const test::TwoSurfaces scene(0.5);
  SceneFlowSegmentation estimate({}, test::kSmallRig);
  const auto stereo = scene.stereo(0);
  estimate(stereo, scene.flow(*stereo, 0));
  for (int frame = 1; frame <= 2 * CameraTrail::kCapacity; ++frame) runEmpty(estimate, frame, "unreadable");
  EXPECT_EQ(estimate(stereo, scene.flow(*stereo, 0))->points.size(),
            test::TwoSurfaces::kWallPoints + test::TwoSurfaces::kCarPoints);
}

/// Cars overtake a camera at 10 m/s at 20 m/s, and fall back at 5 m/s.
TEST(SceneFlowSegmentation, FindsTheDisparityOfANearVehicleWhateverItsSpeed) {
  for (const double car_step_m : {2.0, 0.5}) {
    const test::TwoSurfaces scene(car_step_m);
    SceneFlowSegmentation estimate({}, test::kSmallRig);
    for (int frame = 0; frame < 3; ++frame) {
      const auto stereo = scene.stereo(frame);
      const auto motion = estimate(stereo, scene.flow(*stereo, frame));
      ASSERT_EQ(motion->head.status, FrameStatus::kGood);
      int found = 0;
      for (const ScenePoint& p : motion->points)
        found += scene.onCar(p.point) && std::abs(p.uvd_px.z() - scene.uvd_px(p.point, frame).z()) < 0.5;
      EXPECT_GE(found, 10) << "car moves " << car_step_m << " m, frame " << frame;
    }
  }
}

/// Five frames a second, of which one shows something else and no known point.
TEST(SceneFlowSegmentation, OneBadImageOfASparseDriveBreaksNoLink) {
  const test::TwoSurfaces scene(2.0);
  SceneFlowSegmentation estimate({}, test::kSmallRig);
  for (const int frame : {0, 2, 4}) {
    const auto stereo = scene.stereo(frame);
    ASSERT_EQ(estimate(stereo, scene.flow(*stereo, frame))->head.status, FrameStatus::kGood);
  }
  const auto seen = scene.stereo(6);
  const auto gray =
      test::render(test::kSmallRig.width_px, test::kSmallRig.height_px, [](double, double) { return 128; });
  auto features = std::make_shared<Features>(*seen->features);
  features->left.levels = features->right.levels = {gray};
  auto stereo = std::make_shared<StereoMatches>(*seen);
  stereo->features = features;
  auto flow = std::make_shared<OpticalFlow>(*scene.flow(*seen, 6));
  flow->features = features;
  for (FlowObservation& observed : flow->observations) observed.point.value += 1000, observed.age = 1;
  EXPECT_EQ(estimate(stereo, flow)->head.status, FrameStatus::kLost);

  const auto next = scene.stereo(8);
  const auto motion = estimate(next, scene.flow(*next, 8));
  EXPECT_EQ(motion->head.status, FrameStatus::kGood);
  EXPECT_EQ(motion->head.cause, FrameCause::kAfterGap);
  EXPECT_EQ(motion->head.segment, 0);
  EXPECT_GT(motion->ego_inliers, test::TwoSurfaces::kWallPoints / 2);
}

/// A surface 3 m ahead that keeps the camera's pace.
TEST(SceneFlowSegmentation, PointsThatAreFixedToTheCameraTakePartInNothing) {
  const test::TwoSurfaces scene(test::TwoSurfaces::kCameraStep_m, 3);
  SceneFlowSegmentation estimate({}, test::kSmallRig);
  for (int frame = 0; frame < 5; ++frame) {
    const auto stereo = scene.stereo(frame);
    const auto motion = estimate(stereo, scene.flow(*stereo, frame));
    const auto on_car =
        std::ranges::count_if(motion->points, [&](const ScenePoint& p) { return scene.onCar(p.point); });
    EXPECT_EQ(on_car > 0, frame == 0) << "frame " << frame;
    EXPECT_NEAR(motion->odometry.T_previous_now.translation().z(), frame == 0 ? 0 : test::TwoSurfaces::kCameraStep_m,
                0.05);
    EXPECT_TRUE(motion->components.empty());
  }
}

/// A surface that reaches down to the road walks ahead, or stands. After three steps all of its points tell, but not
/// yet by the bounds of the flow vector.
TEST(SceneFlowSegmentation, FeetThatWalkAreNoRoad) {
  constexpr int kLast = 3;
  SceneFlowSegmentation::Params params;
  params.ground_plane.min_height_m = 0.1;
  params.ground_plane.initial_height_m = 0.3;
  for (const double step_m : {0.0, 0.15}) {
    const test::TwoSurfaces scene(step_m, 7);
    SceneFlowSegmentation estimate(params, test::kSmallRig);
    for (int frame = 0; frame <= kLast; ++frame) {
      const auto stereo = scene.stereo(frame);
      const auto motion = estimate(stereo, scene.flow(*stereo, frame));
      const auto is_road = [&](const ScenePoint& p) { return scene.onCar(p.point) && p.label == PointLabel::kGround; };
      const bool told = frame == kLast && step_m > 0;
      EXPECT_EQ(std::ranges::any_of(motion->points, is_road), !told) << "step " << step_m << " m, frame " << frame;
    }
  }
}

TEST(SceneFlowSegmentation, PointsOnIgnoredPixelsTakePartInNothing) {
  const test::TwoSurfaces scene(0.5);
  PixelMask ignored(test::kSmallRig.width_px, test::kSmallRig.height_px);
  ignored.add(0, 0, 300, test::kSmallRig.height_px);
  SceneFlowSegmentation estimate({}, test::kSmallRig);
  const auto stereo = scene.stereo(0, {.ignored = sharedMask(ignored)});
  const auto motion = estimate(stereo, scene.flow(*stereo, 0));
  EXPECT_GT(motion->points.size(), 20U);
  for (const ScenePoint& p : motion->points) EXPECT_GE(p.uvd_px.x() - p.uvd_px.z(), 299);  // in the right image, too
}

/// Pixels beside each other have other labels, and none has 0.
TEST(SceneFlowSegmentation, PointsCarryTheInstanceLabelOfTheirPixel) {
  constexpr int kLabels = 65535;
  const auto label_of = [](int u, int v) {
    return static_cast<std::uint16_t>(1 + (v * test::kSmallRig.width_px + u) % kLabels);
  };
  auto labels = std::make_shared<InstanceLabels>(test::kSmallRig.width_px, test::kSmallRig.height_px);
  for (int v = 0; v < labels->height(); ++v)
    for (int u = 0; u < labels->width(); ++u) labels->mutableRow(v)[u] = label_of(u, v);
  const test::TwoSurfaces scene(0.5);
  SceneFlowSegmentation estimate({}, test::kSmallRig);
  for (int frame = 0; frame < 2; ++frame) {
    const bool labelled = frame == 1;  // when points are followed
    const auto stereo = scene.stereo(frame, {.ignored = nullptr, .instances = labelled ? labels : nullptr});
    const auto motion = estimate(stereo, scene.flow(*stereo, frame));
    ASSERT_GT(motion->points.size(), 50U);
    for (const ScenePoint& p : motion->points) {
      const int u = static_cast<int>(std::lround(p.uvd_px.x())), v = static_cast<int>(std::lround(p.uvd_px.y()));
      EXPECT_EQ(p.instance, labelled ? label_of(u, v) : 0) << "frame " << frame;
    }
  }
}

}  // namespace
}  // namespace motorcade
