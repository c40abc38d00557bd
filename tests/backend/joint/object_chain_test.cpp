#include "backend/joint/object_chain.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "backend/factors/pose_factors.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

constexpr double kStep_s = 0.1;
const SE3 kCameraStep(expSO3({0, 0.01, 0}), {0, 0, 1.5});
const Eigen::Vector3d kVelocity_mps{0.5, 0, 12};  // over ground, in the axes of the camera that sees it first

/// Body axes: x ahead along the velocity, y left, z up.
SE3 firstSeen() {
  const Eigen::Vector3d ahead = kVelocity_mps.normalized(), up(0, -1, 0);
  Eigen::Matrix3d axes;
  axes << ahead, up.cross(ahead), up;
  return {axes, {3, 1, 20}};
}

/// A camera that drives on by the same step, known to be exact, and an object that is not measured again.
class Chain {
 public:
  explicit Chain(bool use_smoothness = true) : chain_(params_, use_smoothness, solver_, frames_) {}

  /// Adds a frame. `seen` counts until there is a gauge, which the first frame is unless `hold` is false.
  ObjectRecord& extend(const SE3& seen = firstSeen(), bool hold = true) {
    const std::int64_t frame = std::ssize(frames_);
    const SE3 T_world_cam = frame == 0 ? SE3{} : (solver_.pose(frames_.at({frame - 1}).x) * kCameraStep).normalized();
    CameraRecord& camera = frames_[{frame}];
    camera.x = solver_.addVariable(T_world_cam);
    solver_.addFactor(priorFactor(camera.x, T_world_cam, poseSigmas(1e-3, 1e-4, 1e-4)));
    ObjectRecord& record = track_.records[{frame}];
    record.seen.frame = {frame};
    record.stamp.ns = static_cast<std::int64_t>(1e9 * kStep_s) * frame;
    record.seen.T_cam_body = seen;
    if (frame == 0 || !track_.records.at({frame - 1}).pose.valid()) {
      record.seen.velocity_cam_mps = kVelocity_mps;
      chain_.begin(track_, record);
    } else {
      chain_.extend(track_, track_.records.at({frame - 1}), record);
    }
    if (!hold) return record;
    if (!track_.has_gauge) chain_.hold(track_);
    EXPECT_TRUE(solver_.update().problems.empty()) << frame;
    return record;
  }
  /// Tells the camera of a frame anew, as its landmarks do.
  void moveCamera(std::int64_t frame, const SE3& T_world_cam) {
    solver_.addFactor(priorFactor(frames_.at({frame}).x, T_world_cam, poseSigmas(1e-6, 1e-7, 1e-7)));
    for (int i = 0; i < 5; ++i) solver_.update();
  }

  SE3 poseInWorld(std::int64_t frame) const {
    return solver_.pose(frames_.at({frame}).x) * solver_.pose(track_.records.at({frame}).pose);
  }
  Vector6d twistIn(std::int64_t frame) const {
    return std::get<SmallVector>(solver_.estimate(track_.records.at({frame}).twist));
  }
  double sigmaAhead_m(const ObjectRecord& record) const {
    return std::sqrt((*solver_.jointCovariance(std::array{record.pose}))(2, 2));
  }
  ObjectTrack& track() { return track_; }
  ObjectChain& chain() { return chain_; }
  const JointParams& params() const { return params_; }
  IncrementalSolver& solver() { return solver_; }

 private:
  JointParams params_;
  IncrementalSolver solver_{{}};
  std::map<FrameId, CameraRecord> frames_;
  ObjectTrack track_;
  ObjectChain chain_;
};

TEST(ObjectChain, BeginsWhereAndAsFastAsItWasSeen) {
  Chain chain;
  const ObjectRecord& record = chain.extend();
  EXPECT_THAT(chain.solver().pose(record.pose), test::IsNearPose(firstSeen(), 1e-9));
  EXPECT_LT((firstSeen().rotation() * chain.twistIn(0).head<3>() - kVelocity_mps).norm(), 0.01);
  EXPECT_LT(chain.twistIn(0).tail<3>().norm(), 1e-3);
  ASSERT_TRUE(chain.track().shared.valid());
  EXPECT_LT((chain.chain().travelAxes(chain.track()) - Eigen::Matrix3d::Identity()).norm(), 1e-3);
}

/// The object stays where it was spawned, as looking back may find another thing.
TEST(ObjectChain, StaysWhereItWasSpawnedWhateverIsFoundBefore) {
  Chain chain;
  const SE3 elsewhere = SE3(Eigen::Matrix3d::Identity(), {0, 0, -8}) * firstSeen();
  const ObjectRecord& before = chain.extend(elsewhere, false);
  const ObjectRecord& spawned = chain.extend();
  for (int i = 0; i < 5; ++i) chain.solver().update();
  EXPECT_THAT(chain.solver().pose(spawned.pose), test::IsNearPose(firstSeen(), 1e-3));
  const Eigen::Vector3d was = kCameraStep * firstSeen().translation() - kStep_s * kVelocity_mps;
  EXPECT_LT((chain.solver().pose(before.pose).translation() - was).norm(), 0.1) << "its motion leads there";
}

TEST(ObjectChain, StaysWhereItsOwnPointsWereFoundFirst) {
  Chain chain;
  const SE3 found = SE3(Eigen::Matrix3d::Identity(), {0, 0, -0.5}) * firstSeen();
  ObjectRecord& first = chain.extend(found, false);
  first.measured = 4;
  chain.extend();
  for (int i = 0; i < 5; ++i) chain.solver().update();
  EXPECT_THAT(chain.solver().pose(first.pose), test::IsNearPose(found, 1e-3));
}

/// A track whose variables were dropped begins anew, and its earlier poses are no part of the graph any more.
TEST(ObjectChain, TakesNoDroppedPoseForItsGauge) {
  Chain chain;
  ObjectRecord& dropped = chain.extend();
  dropped.measured = 4;
  dropped.pose = dropped.twist = {};
  const SE3 seen = SE3(Eigen::Matrix3d::Identity(), {0, 0, 2}) * firstSeen();
  const ObjectRecord& anew = chain.extend(seen);
  EXPECT_THAT(chain.solver().pose(anew.pose), test::IsNearPose(seen, 1e-3));
}

TEST(ObjectChain, GoesOnInTheWorldWithTheTwistOfTheFrameBefore) {
  Chain chain;
  for (int frame = 0; frame < 4; ++frame) chain.extend();
  for (int frame = 1; frame < 4; ++frame) {
    const Vector6d step = kStep_s * chain.twistIn(frame - 1);
    EXPECT_THAT(chain.poseInWorld(frame), test::IsNearPose(chain.poseInWorld(frame - 1) * SE3::exp(step), 1e-4));
  }
}

TEST(ObjectChain, WithoutSmoothnessNothingIsKnownOfAFrameThatMeasuresNothing) {
  Chain smooth, free(false);
  for (int frame = 0; frame < 2; ++frame) smooth.extend(), free.extend();
  const double sigma_m = smooth.sigmaAhead_m(smooth.extend());
  EXPECT_LT(sigma_m, smooth.params().twist_sigma_mps);  // two tenths of a second at an unknown speed, and some
  EXPECT_GT(free.sigmaAhead_m(free.extend()), 3 * sigma_m);
}

/// The camera's motion enters as known, and must follow when it turns out to be another one.
TEST(ObjectChain, AMotionThatIsToldAnewFollowsTheCamera) {
  Chain chain;
  const int track_frames = chain.params().track_frames;
  for (int frame = 0; frame <= track_frames + 1; ++frame) chain.extend();
  const FactorId before = *chain.track().records.at({1}).motion;
  const std::size_t factors = chain.solver().graph().factorCount();
  chain.chain().renewMotion(chain.track(), {track_frames});
  EXPECT_FALSE(chain.track().records.at({0}).motion);
  EXPECT_EQ(*chain.track().records.at({1}).motion, before) << "frame 0 has no motion to tell";

  const SE3 T_world_cam = kCameraStep * SE3(Eigen::Matrix3d::Identity(), {0, 0, 0.2});
  chain.moveCamera(1, T_world_cam);
  const Eigen::Vector3d seen_before = chain.solver().pose(chain.track().records.at({1}).pose).translation();
  chain.chain().renewMotion(chain.track(), {track_frames + 1});
  for (int i = 0; i < 5; ++i) chain.solver().update();
  EXPECT_EQ(chain.solver().graph().factorCount(), factors + 1) << "the camera's new prior";
  const Eigen::Vector3d seen = chain.solver().pose(chain.track().records.at({1}).pose).translation();
  EXPECT_NEAR(seen_before.z() - seen.z(), 0.2, 0.02) << "the object stays in the world";
}

}  // namespace
}  // namespace motorcade
