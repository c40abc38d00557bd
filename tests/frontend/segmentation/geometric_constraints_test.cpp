#include "frontend/segmentation/geometric_constraints.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "frontend/motion/shared_velocity_error.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

const Eigen::Vector3d kSigma_px(0.3, 0.3, 0.3);
const SE3 kT_now_then(Eigen::Matrix3d::Identity(), {0, 0, -3});  // 3 m straight ahead

std::optional<GeometricResidual> residual(const Eigen::Vector3d& p_then, const Eigen::Vector3d& step_m,
                                          const SE3& T_now_then = kT_now_then) {
  const Eigen::Vector3d now = *kRig.project(T_now_then * Eigen::Vector3d(p_then + step_m));
  return geometricResidual(kRig, {*kRig.project(p_then), kSigma_px, now, kSigma_px}, T_now_then);
}

TEST(GeometricConstraints, APointAtRestKeepsBoth) {
  test::Noise noise(1);
  for (int i = 0; i < 100; ++i) {
    Eigen::Vector3d p = test::streetPoint(noise, 6, 50);
    p.x() += p.x() < 0 ? -1 : 1;  // away from the epipole, where no line exists
    const SE3 motion(expSO3({0.001, 0.03, 0}), {0.1, 0, -3});
    const auto r = residual(p, {0, 0, 0}, motion);
    ASSERT_TRUE(r);
    EXPECT_LT(r->epipolar_sigmas, 1e-6);  // rounding
    EXPECT_EQ(r->flow_bound_px, 0);
  }
}

TEST(GeometricConstraints, ASidewaysMoverLeavesTheEpipolarLine) {
  const auto r =
      residual({0.2, 2, 15}, {0.5, 0, 0});  // the line points down, the mover goes right by 0.5 m: 30 px at 12 m
  ASSERT_TRUE(r);
  EXPECT_GT(r->epipolar_sigmas, 20);
}

TEST(GeometricConstraints, AMoverAlongTheLineExceedsTheFlowBoundOnly) {
  // It drives along our own direction: seen from a camera that goes straight it stays in the plane of its epipolar
  // line.
  for (const double step_m : {-3.0, 3.0}) {
    const auto r = residual({4, 1.5, 15}, {0, 0, step_m});
    ASSERT_TRUE(r);
    EXPECT_LT(r->epipolar_sigmas, 1e-6);
    EXPECT_GT(r->flow_bound_px, 5);  // at rest it flows by 48 px, oncoming by 128, at our own speed not at all
  }
}

TEST(GeometricConstraints, PureRotationHasNoEpipolarLine) {
  EXPECT_FALSE(residual({4, 1, 15}, {0, 0, 0}, SE3(expSO3({0, 0.05, 0}), {0, 0, 0})));
}

TEST(GeometricConstraints, APointThatWePassedHasNone) {
  const Eigen::Vector3d p(0.5, 0.2, 2);
  EXPECT_FALSE(geometricResidual(kRig, {*kRig.project(p), kSigma_px, {600, 180, 20}, kSigma_px}, kT_now_then));
}

/// Follows a point over frames in which the camera drives 1 m each. In the first camera's frame the point starts at `p`
/// and moves by `step_m` each.
bool violates(int frames, const Eigen::Vector3d& p, const Eigen::Vector3d& step_m) {
  CameraTrail trail;
  PointTrack track;
  for (int k = 0; k < frames; ++k) {
    trail.add({k * 100'000'000}, k ? SE3(Eigen::Matrix3d::Identity(), {0, 0, 1}) : SE3{});
    const Eigen::Vector3d p_cam = p + k * step_m - Eigen::Vector3d(0, 0, k);
    track.add({k, kRig.project(p_cam)->cast<float>(), kSigma_px.cast<float>()});
  }
  return violatesGeometry(kRig, track, trail);
}

TEST(GeometricConstraints, ATrackIsJudgedOverAllItsFrames) {
  const Eigen::Vector3d p(3, 1.5, 15), slow(0.02, 0, 0);
  EXPECT_FALSE(violates(8, p, {0, 0, 0}));
  EXPECT_FALSE(violates(3, p, slow));
  EXPECT_TRUE(violates(8, p, slow));  // 0.14 m aside at 8 m are 12 px
  EXPECT_TRUE(violates(3, p, {0.5, 0, 0}));
}

TEST(GeometricConstraints, ATrackOfTwoObservationsIsNotJudged) { EXPECT_FALSE(violates(2, {3, 1.5, 15}, {0.5, 0, 0})); }

TEST(GeometricConstraints, ATrackOlderThanTheTrailIsNotJudged) {
  EXPECT_TRUE(violates(CameraTrail::kCapacity, {3, 1.5, 25}, {0.5, 0, 0}));
  CameraTrail trail;
  PointTrack track;
  for (int k = 0; k < 3; ++k) track.add({k, {600, 180, 20}, kSigma_px.cast<float>()});
  for (int k = 0; k < 2 * CameraTrail::kCapacity; ++k) trail.add({k * 100'000'000}, SE3{});
  EXPECT_FALSE(violatesGeometry(kRig, track, trail));
}

/// Scene flow of a point 15 m ahead, known to 0.05 m/s across the view and to 0.5 m/s along it.
SceneFlow flowAhead(const Eigen::Vector3d& velocity_mps) {
  SceneFlow flow{.p_cam = {0, 1, 15}, .velocity_mps = velocity_mps, .covariance = Matrix6d::Identity()};
  flow.covariance.bottomRightCorner<3, 3>() = Eigen::Vector3d(0.05, 0.05, 0.5).cwiseAbs2().asDiagonal();
  return flow;
}

TEST(SureMotion, IsBeyondTheNoiseOfItsDirection) {
  constexpr double kWalk_mps = 1.4, kCamera_mps = 3;
  EXPECT_TRUE(movesSurely(kRig, flowAhead({kWalk_mps, 0, 0}), kCamera_mps));
  EXPECT_FALSE(movesSurely(kRig, flowAhead({0, 0, kWalk_mps}), kCamera_mps));
  EXPECT_TRUE(movesSurely(kRig, flowAhead({0, 0, 2 * kWalk_mps}), kCamera_mps));
}

TEST(SureMotion, IsBeyondTheErrorsThatPointsShareAtSpeed) {
  const SceneFlow flow = flowAhead({0.6, 0, 0});
  EXPECT_TRUE(movesSurely(kRig, flow, 3));
  EXPECT_FALSE(movesSurely(kRig, flow, 13));
}

TEST(SureMotion, OnePointAtRestOfAThousandSeemsToMove) {
  constexpr double kCamera_mps = 10;
  const SceneFlow at_rest = flowAhead({0, 0, 0});
  const Eigen::Matrix3d C =
      at_rest.covariance.bottomRightCorner<3, 3>() + sharedVelocityCovariance(kRig, at_rest.p_cam, kCamera_mps);
  const Eigen::Matrix3d root = C.llt().matrixL();
  test::Noise noise(1);
  int moving = 0;
  for (int i = 0; i < 20'000; ++i)
    moving += movesSurely(kRig, flowAhead(root * noise.gaussian(Eigen::Vector3d(1, 1, 1))), kCamera_mps);
  EXPECT_GE(moving, 8);  // of 20 that are expected
  EXPECT_LE(moving, 34);
}

}  // namespace
}  // namespace motorcade
