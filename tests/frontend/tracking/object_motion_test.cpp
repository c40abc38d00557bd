#include "frontend/tracking/object_motion.hpp"

#include <gtest/gtest.h>

#include "tests/frontend/tracking/textured_board.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::IsNearPose;
using test::kRig;

/// A car ahead, seen without noise, its points known exactly; the camera stands.
struct CarAhead {
  SceneMotion now;
  TrackedObject object;
  SE3 T_cam_body;

  explicit CarAhead(int points) {
    Eigen::Matrix3d upright;  // columns: ahead = camera's z, left = -x, up = -y
    upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    T_cam_body = SE3(upright, {1, 1, 12});
    Vector6d twist;
    twist << 8, 0, 0, 0, 0, 0.1;
    now.head.frame = {5};
    test::Noise noise(1);
    for (std::int64_t id = 0; id < points; ++id) {
      const Eigen::Vector3d p = noise.inBox({-1, -0.9, -0.6}, {1, 0.9, 0.8});
      now.points.push_back(
          {.point = {id}, .uvd_px = *kRig.project(T_cam_body * p), .sigma_px = test::kObservationSigma_px, .flow = {}});
      object.points.push_back({{id}, p, 1e-4 * Eigen::Matrix3d::Identity()});
    }
    object.kinematics = ObjectKinematics(T_cam_body, twist, 0.04 * Matrix12d::Identity());
    object.T_cam_body = T_cam_body;
  }
  std::optional<ObjectObservation> follow() { return ObjectMotionEstimator({}, kRig).follow(object, now, SE3{}); }
};

TEST(ObjectMotion, NoiseFreePointsGiveTheExactEncounter) {
  CarAhead car(30);
  const auto o = car.follow();
  ASSERT_TRUE(o);
  EXPECT_EQ(o->points, 30);
  EXPECT_THAT(o->T_cam_body, IsNearPose(car.T_cam_body, 1e-6));  // the fit's last step
}

/// One of four points, by its number, is displaced by less than a gross error, which is 7 mm at 12 m.
TEST(ObjectMotion, AllPointsMeasureTheEncounter) {
  for (const std::int64_t rest : {0, 1, 2, 3}) {
    CarAhead car(30);
    for (auto& p : car.now.points)
      if (p.point.value % 4 == rest) p.uvd_px.x() += 0.4;
    const auto o = car.follow();
    ASSERT_TRUE(o);
    EXPECT_GT((car.T_cam_body.inverse() * o->T_cam_body).log().norm(), 1e-3) << rest;
  }
}

TEST(ObjectMotion, TwoPointsMeasureNothing) {
  CarAhead hardly(2);
  EXPECT_FALSE(hardly.follow());
}

/// A frame in which none of the car's own points was followed, only others.
struct Unfollowed : CarAhead {
  PosePrior predicted{T_cam_body, (0.04 * Matrix6d::Identity()).inverse()};
  Unfollowed() : CarAhead(30) { now.points.clear(); }
  void see(int count, const Eigen::Vector3d& p_body, PointLabel label) {
    for (int i = 0; i < count; ++i) {
      const PointId id{1000 + static_cast<std::int64_t>(now.points.size())};
      const Eigen::Vector3d uvd = *kRig.project(T_cam_body * (p_body + Eigen::Vector3d(0, 0.1 * i, 0)));
      now.points.push_back(
          {.point = id, .uvd_px = uvd, .sigma_px = test::kObservationSigma_px, .label = label, .flow = {}});
    }
  }
  std::optional<ObjectObservation> visibleEvidence() const {
    return ObjectMotionEstimator({}, kRig).visibleEvidence(object, now, predicted);
  }
};

TEST(ObjectMotion, PointsWithinItsOutlineShowThatAnObjectIsWhereItWasPredicted) {
  Unfollowed frames;
  frames.see(4, {-0.5, 0, 0.3}, PointLabel::kUnknown);
  const auto o = frames.visibleEvidence();
  ASSERT_TRUE(o);
  EXPECT_EQ(o->points, 4);
  EXPECT_THAT(o->T_cam_body, IsNearPose(frames.T_cam_body, 0.0));
  EXPECT_GE(o->encounter_covariance.diagonal().head<3>().minCoeff(), 1.0);  // it tells little that was not known
  EXPECT_LT(o->box.left_px, o->box.right_px);
}

TEST(ObjectMotion, PointsAtRestBesideOrTooFewShowNoObject) {
  Unfollowed at_rest, beside, few;
  at_rest.see(4, {-0.5, 0, 0.3}, PointLabel::kStatic);
  at_rest.see(4, {-0.5, 0, -0.4}, PointLabel::kGround);
  beside.see(4, {-0.5, 3, 0.3}, PointLabel::kUnknown);
  few.see(2, {-0.5, 0, 0.3}, PointLabel::kUnknown);
  for (const auto* frames : {&at_rest, &beside, &few}) EXPECT_FALSE(frames->visibleEvidence());
}

TEST(ObjectMotion, AnObjectThatIsPredictedOutsideTheImageIsNotThere) {
  Unfollowed frames;
  frames.see(4, {-0.5, 0, 0.3}, PointLabel::kUnknown);
  frames.predicted.mean = SE3(frames.T_cam_body.rotation(), {0, 0, -2});
  EXPECT_FALSE(frames.visibleEvidence());
  frames.predicted.mean = SE3(frames.T_cam_body.rotation(), {-12, 1, 12});
  EXPECT_FALSE(frames.visibleEvidence());
}

TEST(ObjectMotion, PointsThatLeaveTheBodyAreDropped) {
  CarAhead car(30);
  for (std::size_t i = 0; i < 3; ++i) car.now.points[i].uvd_px.x() += 30;
  ASSERT_TRUE(car.follow());
  EXPECT_EQ(car.object.points.size(), 30U);  // once may be a mistake
  ASSERT_TRUE(car.follow());
  EXPECT_EQ(car.object.points.size(), 27U);
}

/// Someone who walks before a far wall, in clothes with a texture.
struct Pedestrian {
  TrackedObject object;
  SceneMotion scene;

  explicit Pedestrian(double speed_mps) {
    object.T_cam_body = test::TexturedBoard::standingAt(-1, 14);
    Vector6d twist = Vector6d::Zero();
    twist[0] = speed_mps;
    object.kinematics = ObjectKinematics(object.T_cam_body, twist, 0.01 * Matrix12d::Identity());
    scene.features = test::TexturedBoard::seenAt(object.T_cam_body);
    for (const double y : {-0.2, 0.2})
      for (const double z : {-0.2, 0.2}) {
        const Eigen::Vector3d p_body(0, y, z);
        scene.points.push_back({.point = {std::ssize(scene.points)},
                                .uvd_px = *kRig.project(object.T_cam_body * p_body),
                                .sigma_px = test::kObservationSigma_px,
                                .flow = {}});
        object.points.push_back(toBody(scene.points.back(), object.T_cam_body, kRig));
      }
  }
  void cover() {
    const ObjectMotionEstimator motion({}, kRig);
    if (object.measured.points.empty()) object.measured = motion.measuredPoints(object, scene);
    motion.addPatches(scene, object.T_cam_body, object, object.measured);
  }
  double height_m() const { return object.extent(0).sizes().z(); }
};

/// Someone of whom one point is still followed, which moves as the person does.
struct OnePointOfAPerson : Pedestrian {
  OnePointOfAPerson() : Pedestrian(1.4) {
    object.born_slow = true;
    object.points.resize(1);
    scene.points.resize(1);
    scene.features = nullptr;  // no patches
    ScenePoint& point = scene.points.front();
    point.flow = SceneFlow{.p_cam = kRig.triangulate(point.uvd_px),
                           .velocity_mps = object.kinematics.velocityWorld_mps(),
                           .covariance = 0.01 * Eigen::Matrix<double, 6, 6>::Identity()};
  }
  bool follow() { return ObjectMotionEstimator({}, kRig).follow(object, scene, SE3{}).has_value(); }
};

TEST(ObjectMotion, OnePointThatSurelyMovesFollowsAWalker) {
  OnePointOfAPerson person;
  EXPECT_TRUE(person.follow());
}

TEST(ObjectMotion, OnePointThatMayRestFollowsNobody) {
  OnePointOfAPerson person;
  person.scene.points.front().flow->covariance *= 100;
  EXPECT_FALSE(person.follow());
}

TEST(ObjectMotion, OnePointThatMovesAnotherWayFollowsNobody) {
  OnePointOfAPerson person;
  person.scene.points.front().flow->velocity_mps *= -1;
  EXPECT_FALSE(person.follow());
}

TEST(ObjectMotion, APointOfAShadowFollowsNobody) {
  OnePointOfAPerson person;
  const double height_m = person.scene.ground.heightOf_m(person.scene.points.front().flow->p_cam);
  person.scene.points.front().flow->p_cam.y() += height_m - 0.2;
  EXPECT_FALSE(person.follow());
}

TEST(ObjectMotion, OnePointFollowsNoVehicle) {
  OnePointOfAPerson slow_car;
  slow_car.object.born_slow = false;
  EXPECT_FALSE(slow_car.follow());
}

TEST(ObjectMotion, PatchesCoverAPersonBeyondThePointsFollowed) {
  Pedestrian pedestrian(1.4);
  pedestrian.cover();
  EXPECT_GT(pedestrian.object.points.size(), 20U);
  EXPECT_EQ(pedestrian.object.points.size(), pedestrian.object.measured.points.size());
  EXPECT_GT(pedestrian.height_m(), 0.8);
  EXPECT_LT(pedestrian.height_m(), 1.4);
  const std::size_t covered = pedestrian.object.points.size();
  pedestrian.cover();
  EXPECT_EQ(pedestrian.object.points.size(), covered) << "those of the frame before are gone";
  EXPECT_EQ(std::ranges::count_if(pedestrian.object.points, [](const auto& p) { return isFollowed(p.point); }), 4);
}

/// Points on a leg, which swings, say where the rest of a person is.
TEST(ObjectMotion, PatchesLieOnTheTrunkAndHeadOfAPerson) {
  constexpr double kBelow_m = 0.7;  // the board's middle, where the leg is
  Pedestrian pedestrian(1.4);
  for (BodyPoint& p : pedestrian.object.points) p.p_body.z() -= kBelow_m;
  for (ScenePoint& p : pedestrian.scene.points) p.uvd_px.y() += kRig.fy_px * kBelow_m / 14;
  pedestrian.cover();
  const double middle_m = pedestrian.object.T_cam_body.translation().x();
  int patches = 0;
  for (const ScenePoint& p : pedestrian.object.measured.points) {
    if (isFollowed(p.point)) continue;
    ++patches;
    const Eigen::Vector3d p_cam = kRig.triangulate(p.uvd_px);
    constexpr double kSlack_m = 0.05;  // patches' depths are off by a percent or two
    EXPECT_GT(pedestrian.scene.ground.heightOf_m(p_cam), 0.8 - kSlack_m);
    EXPECT_LT(pedestrian.scene.ground.heightOf_m(p_cam), 1.8 + kSlack_m);
    EXPECT_LT(std::abs(p_cam.x() - middle_m), 0.3 + 0.25) << "points reach .2 m to each side of their middle";
  }
  EXPECT_GT(patches, 30);
}

TEST(ObjectMotion, PatchesFollowPatchesWhereNoPointIsLeft) {
  Pedestrian pedestrian(1.4);
  pedestrian.cover();
  std::erase_if(pedestrian.object.measured.points, [](const auto& p) { return isFollowed(p.point); });
  std::erase_if(pedestrian.object.points, [](const auto& p) { return isFollowed(p.point); });
  pedestrian.cover();
  EXPECT_GT(pedestrian.object.points.size(), 20U);
}

TEST(ObjectMotion, PatchesLieBetweenThePointsOfOtherObjects) {
  Pedestrian rider(6);
  rider.cover();
  EXPECT_LT(rider.height_m(), 0.5);
}

}  // namespace
}  // namespace motorcade
