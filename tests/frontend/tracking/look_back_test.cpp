#include "frontend/tracking/look_back.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <gtest/gtest.h>

#include "tests/frontend/tracking/textured_board.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNearPose;
using test::kRig;
using test::TexturedBoard;

constexpr double kSpeed_mps = 8, kFrame_s = 0.1;
constexpr int kFrames = 7, kConfirmed = 6, kSpawned = 4;

SE3 boardIn(int frame, double speed_mps = kSpeed_mps) {
  return TexturedBoard::standingAt(-1, 14 + speed_mps * kFrame_s * frame);
}
Timestamp stampOf(int frame) { return Timestamp{static_cast<std::int64_t>(1e9 * kFrame_s) * frame}; }

/// A board that drives ahead of a standing camera. Corners on it are followed from the frame in which it was spawned
/// on; the images show it from `first_seen` on.
struct BoardDrive {
  TrackedObject object;
  LookBack look_back{12, 3, {}, kRig};

  /// Another object was reported `other_ahead_m` ahead of the board's place in the frames before `other_until`.
  explicit BoardDrive(int first_seen, int other_until = 0, double other_ahead_m = 0, double other_height_m = 1.5) {
    TrackedObject other;
    other.track = {9};
    for (const double z_m : {0.0, other_height_m})
      other.points.push_back({{}, {0, 0, z_m}, Eigen::Matrix3d::Identity()});
    for (int frame = 0; frame < kFrames; ++frame) {
      std::vector<ObjectObservation> reported;
      if (frame < other_until) {
        reported.emplace_back();
        reported.back().track = other.track;
        reported.back().frame = {frame};
        reported.back().T_cam_body = boardIn(frame) * SE3(Eigen::Matrix3d::Identity(), {other_ahead_m, 0, 0});
      }
      look_back.remember(scene(frame, frame >= first_seen), SE3{}, reported, {other});
    }
    const SE3 T_cam_body = boardIn(kConfirmed);
    for (const ScenePoint& p : TexturedBoard::points(T_cam_body, 6, 100))
      object.points.push_back(toBody(p, T_cam_body, kRig));
    Vector6d twist = Vector6d::Zero();
    twist[0] = kSpeed_mps + 0.3;
    Matrix12d covariance = 1e-4 * Matrix12d::Identity();
    covariance.bottomRightCorner<6, 6>() *= 2500;
    object.kinematics = ObjectKinematics(T_cam_body, twist, covariance);
    for (int frame = kSpawned; frame <= kConfirmed; ++frame) {
      ObjectObservation seen;
      seen.frame = {frame};
      seen.T_cam_body = boardIn(frame);
      for (const ScenePoint& p : TexturedBoard::points(seen.T_cam_body, 6, 100))
        seen.measured.push_back(measurementOf(p, 0));
      object.backlog.push_back(std::move(seen));
    }
  }
  static SceneMotionPtr scene(int frame, bool there) {
    auto scene = std::make_shared<SceneMotion>();
    scene->head.frame = {frame};
    scene->head.stamp = stampOf(frame);
    scene->features = TexturedBoard::seenAt(boardIn(frame), there);
    if (frame >= kSpawned) scene->points = TexturedBoard::points(boardIn(frame), 6, 100);
    return scene;
  }
  void lookBack() { look_back(object, stampOf(kConfirmed), {}); }
};

TEST(LookBack, FindsAnObjectInFramesInWhichNoCornerOnItWasFollowed) {
  BoardDrive drive(0);
  drive.lookBack();
  ASSERT_EQ(drive.object.backlog.size(), static_cast<std::size_t>(kFrames));
  for (int frame = 0; frame < kSpawned; ++frame) {
    const ObjectObservation& seen = drive.object.backlog[frame];
    EXPECT_EQ(seen.frame.value, frame);
    EXPECT_GE(seen.points, 6);
    EXPECT_THAT(seen.T_cam_body, IsNearPose(boardIn(frame), 0.15));
    for (const PointMeasurement& p : seen.measured) EXPECT_NE(drive.object.find(p.point), nullptr);
  }
}

/// The object is confirmed two frames after it was spawned, where one is the fewest.
TEST(LookBack, LooksAsFarBackForAnObjectThatIsConfirmedLate) {
  constexpr int kBack = 3;
  BoardDrive drive(0);
  drive.look_back = LookBack(kBack, 1, {}, kRig);
  for (int frame = 0; frame < kFrames; ++frame) drive.look_back.remember(BoardDrive::scene(frame, true), SE3{}, {}, {});
  drive.lookBack();
  ASSERT_FALSE(drive.object.backlog.empty());
  EXPECT_EQ(drive.object.backlog.front().frame.value, kSpawned - kBack);
}

TEST(LookBack, EndsWhereTheObjectIsNotSeen) {
  BoardDrive drive(2);
  drive.lookBack();
  ASSERT_FALSE(drive.object.backlog.empty());
  EXPECT_EQ(drive.object.backlog.front().frame.value, 2);
}

TEST(LookBack, EndsWhereAnotherObjectWasReportedInItsPlace) {
  BoardDrive taken(0, 2, 1.5), behind_another(0, 2, 6);
  taken.lookBack();
  EXPECT_EQ(taken.object.backlog.front().frame.value, 2);
  behind_another.lookBack();
  EXPECT_EQ(behind_another.object.backlog.front().frame.value, 0);
}

/// An object that nothing shows before it was spawned, and what rests where it was then.
TrackedObject beforeRestingPoints(double speed_mps, bool born_slow) {
  LookBack look_back{12, 3, {}, kRig};
  for (int frame = 0; frame < kFrames; ++frame) {
    auto scene = std::make_shared<SceneMotion>();
    scene->head.frame = {frame};
    scene->head.stamp = stampOf(frame);
    scene->features = TexturedBoard::seenAt(boardIn(frame, speed_mps), frame >= kSpawned);
    if (frame >= kSpawned) scene->points = TexturedBoard::points(boardIn(frame, speed_mps), 6, 100);
    std::ranges::move(TexturedBoard::points(boardIn(kSpawned, speed_mps), 20, 500), std::back_inserter(scene->points));
    look_back.remember(scene, SE3{}, {}, {});
  }
  TrackedObject object = BoardDrive(kSpawned).object;
  object.born_slow = born_slow;
  const SE3 T_cam_body = boardIn(kConfirmed, speed_mps);
  Vector6d twist = Vector6d::Zero();
  twist[0] = speed_mps;
  Matrix12d covariance = 1e-4 * Matrix12d::Identity();
  covariance.bottomRightCorner<6, 6>() *= 400;
  object.kinematics = ObjectKinematics(T_cam_body, twist, covariance);
  object.points.clear();
  for (const ScenePoint& p : TexturedBoard::points(T_cam_body, 6, 100))
    object.points.push_back(toBody(p, T_cam_body, kRig));
  for (ObjectObservation& seen : object.backlog) {
    seen.T_cam_body = boardIn(static_cast<int>(seen.frame.value), speed_mps);
    seen.measured.clear();
    for (const ScenePoint& p : TexturedBoard::points(seen.T_cam_body, 6, 100))
      seen.measured.push_back(measurementOf(p, 0));
  }
  look_back(object, stampOf(kConfirmed), {});
  return object;
}

TEST(LookBack, IsNotHeldByPointsThatRestWhereTheObjectWas) {
  for (const auto& [speed_mps, born_slow] : {std::pair(kSpeed_mps, false), std::pair(1.4, true)}) {
    const TrackedObject object = beforeRestingPoints(speed_mps, born_slow);
    for (const ObjectObservation& seen : object.backlog) {
      const int frame = static_cast<int>(seen.frame.value);
      EXPECT_THAT(seen.T_cam_body, IsNearPose(boardIn(frame, speed_mps), 0.1)) << speed_mps << " m/s, frame " << frame;
    }
  }
}

TEST(LookBack, EndsOnTheFlankOfATallVehicleThatWasReported) {
  BoardDrive on_a_lorry(0, 2, 6, 2.5), behind_a_lorry(0, 2, 10, 2.5);
  on_a_lorry.lookBack();
  EXPECT_EQ(on_a_lorry.object.backlog.front().frame.value, 2);
  behind_a_lorry.lookBack();
  EXPECT_EQ(behind_a_lorry.object.backlog.front().frame.value, 0);
}

}  // namespace
}  // namespace motorcade
