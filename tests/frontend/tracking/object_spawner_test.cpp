#include "frontend/tracking/object_spawner.hpp"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "tests/frontend/tracking/textured_board.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::TexturedBoard;

constexpr double kStride_s = 0.1, kWalk_mps = 1.4;
constexpr std::int64_t kFollowed = 7;

SE3 toTheRight(double x_m) { return {Eigen::Matrix3d::Identity(), {x_m, 0, 0}}; }

/// A board before the camera in two frames, to the right of the place where it was, and one point on it.
struct Stride {
  SceneMotion before, now;
  MotionComponent component;  // of the one point

  /// The board moves by `moved_m` to the right; the point seems to move at `speed_mps`, whatever the board does.
  Stride(const TexturedBoard::Paint& paint, double moved_m, double speed_mps) {
    show({{kNow, paint}}, {{toTheRight(-moved_m) * kNow, paint}});
    before.head.frame = {4}, now.head.frame = {5};
    now.head.stamp = {static_cast<std::int64_t>(1e9 * kStride_s)};
    const Eigen::Vector3d p_cam = kNow * Eigen::Vector3d(0, 0.05, -0.3);
    now.points.push_back(
        {.point = {kFollowed}, .uvd_px = *kRig.project(p_cam), .sigma_px = test::kObservationSigma_px, .flow = {}});
    component.points = {0};
    component.centroid_cam = p_cam;
    component.velocity_mps = {speed_mps, 0, 0};
    component.velocity_covariance = 0.01 * Eigen::Matrix3d::Identity();
  }
  void show(const std::vector<TexturedBoard::Painted>& boards_now,
            const std::vector<TexturedBoard::Painted>& boards_before) {
    now.features = TexturedBoard::seen(boards_now);
    before.features = TexturedBoard::seen(boards_before);
  }
  std::optional<TrackedObject> walker() const { return ObjectSpawner({}, kRig).walker(now, before, component, SE3{}); }

  static const SE3 kNow;
};
const SE3 Stride::kNow = TexturedBoard::standingAt(-1, 14);

constexpr double kStride_m = kWalk_mps * kStride_s;

TEST(ObjectSpawner, SpawnsAWalkerOfOnePointWherePatchesMovedWithIt) {
  const Stride frames(TexturedBoard::person, kStride_m, kWalk_mps);
  const auto walker = frames.walker();
  ASSERT_TRUE(walker);
  EXPECT_TRUE(walker->born_slow);
  EXPECT_TRUE(walker->track.valid());
  EXPECT_NE(walker->find({kFollowed}), nullptr);
  EXPECT_GT(walker->points.size(), 20U) << "patches cover the trunk";
  EXPECT_NEAR(walker->kinematics.velocityWorld_mps().x(), kWalk_mps, 1e-9);
}

TEST(ObjectSpawner, TakesTheCamerasMotionOffAWalk) {
  const SE3 T_previous_now(expSO3({0, 0.01, 0}), {0.1, 0, 0.4});
  Stride walks(TexturedBoard::person, 0, kWalk_mps), stands = walks;
  walks.now.odometry.T_previous_now = stands.now.odometry.T_previous_now = T_previous_now;
  const TexturedBoard::Painted now{Stride::kNow, TexturedBoard::person};
  walks.show({now}, {{T_previous_now * toTheRight(-kStride_m) * Stride::kNow, TexturedBoard::person}});
  stands.show({now}, {{T_previous_now * Stride::kNow, TexturedBoard::person}});
  EXPECT_TRUE(walks.walker());
  EXPECT_FALSE(stands.walker());
}

/// A slow wrong point leads the search for patches near the place where they are at rest: they are found there.
TEST(ObjectSpawner, SpawnsNoWalkerWhereAWrongPointIsOnSomethingAtRest) {
  for (const double wrong_mps : {0.6, kWalk_mps})
    EXPECT_FALSE(Stride(TexturedBoard::person, 0, wrong_mps).walker()) << wrong_mps;
}

TEST(ObjectSpawner, SpawnsNoWalkerThatIsFasterThanAPerson) {
  EXPECT_FALSE(Stride(TexturedBoard::person, 6 * kStride_s, 6).walker());
  EXPECT_TRUE(Stride(TexturedBoard::person, 2.7 * kStride_s, 2.7).walker());
  EXPECT_FALSE(Stride(TexturedBoard::person, 3.3 * kStride_s, 2.7).walker()) << "by its patches";
}

TEST(ObjectSpawner, AsksForAWalkersPatchesWhereALowPointWalksSurely) {
  const Stride frames(TexturedBoard::person, kStride_m, kWalk_mps);
  const ObjectSpawner spawner({}, kRig);
  const auto may_be = [&](double speed_mps, double sigma_mps, double height_m) {
    MotionComponent component = frames.component;
    component.velocity_mps = {speed_mps, 0, 0};
    component.velocity_covariance = sigma_mps * sigma_mps * Eigen::Matrix3d::Identity();
    return spawner.mayBeWalker(component, {.normal_cam = {0, 1, 0}, .height_m = component.centroid_cam.y() + height_m});
  };
  EXPECT_TRUE(may_be(kWalk_mps, 0.4, 1.2));
  EXPECT_FALSE(may_be(kWalk_mps, 0.5, 1.2)) << "2.8 standard deviations";
  EXPECT_FALSE(may_be(kWalk_mps, 0.4, 2.5)) << "in a tree";
  EXPECT_FALSE(may_be(4, 0.4, 1.2)) << "rides";
}

TEST(ObjectSpawner, SpawnsNoWalkerAsLargeAsACar) {
  Stride frames(TexturedBoard::paint, kStride_m, kWalk_mps);
  frames.now.points.clear(), frames.component.points.clear();
  for (int i = 0; i < 12; ++i) {  // all over the board, and followed since the frame before
    const Eigen::Vector3d p_cam = Stride::kNow * Eigen::Vector3d(0, -1.4 + 2.8 / 11 * i, 0.2);
    ScenePoint point{.point = {i}, .uvd_px = *kRig.project(p_cam), .sigma_px = test::kObservationSigma_px, .flow = {}};
    frames.now.points.push_back(point);
    point.uvd_px = *kRig.project(toTheRight(-kStride_m) * p_cam);
    frames.before.points.push_back(point);
    frames.component.points.push_back(i);
  }
  EXPECT_FALSE(frames.walker());
}

/// A badge on a plain wall moved: less than a trunk shows.
TEST(ObjectSpawner, SpawnsNoWalkerOfTooFewPatches) {
  const auto badge = [](double half_m) {
    return Stride(
        [=](double right_m, double down_m) -> std::optional<double> {
          if (std::abs(right_m) > 2 || std::abs(down_m) > 2) return std::nullopt;
          return std::hypot(right_m, down_m + 0.2) < half_m ? TexturedBoard::texture(right_m, down_m) : 128;
        },
        kStride_m, kWalk_mps);
  };
  EXPECT_FALSE(badge(0).walker());
  EXPECT_FALSE(badge(0.08).walker()) << "seven patches";
  EXPECT_TRUE(badge(0.2).walker());
}

/// The same size at rest, of which a part moved: an arm, or leaves.
TEST(ObjectSpawner, SpawnsNoWalkerWhereMostPatchesRest) {
  const auto part = [](double from_m) {
    const auto strip = [=](double right_m, double down_m) -> std::optional<double> {
      if (right_m < from_m) return std::nullopt;
      return TexturedBoard::person(right_m, down_m);
    };
    const auto rest = [](double right_m, double down_m) -> std::optional<double> {
      if (std::abs(right_m) > 1 || std::abs(down_m) > 1) return std::nullopt;
      return TexturedBoard::texture(right_m + 5, down_m);
    };
    Stride frames(TexturedBoard::person, 0, kWalk_mps);
    const SE3 still = Stride::kNow;
    frames.show({{still, strip}, {still, rest}}, {{toTheRight(-kStride_m) * still, strip}, {still, rest}});
    return frames;
  };
  EXPECT_TRUE(part(-0.2).walker());
  EXPECT_FALSE(part(0.1).walker());
}

}  // namespace
}  // namespace motorcade
