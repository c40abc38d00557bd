#include "backend/window/estimate_reader.hpp"

#include <algorithm>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/pose_graph/anchored_pose_graph.hpp"
#include "tests/backend/simulated_drive.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;
using test::numericJacobian;
using test::SimulatedDrive;
using testing::Each;
using testing::Field;

constexpr int kReadFrames = 16;
constexpr FrameId kLast{kReadFrames - 1};

/// A drive of `kReadFrames` frames in a graph, changed by `change` frame by frame.
class EstimateReaderTest : public testing::Test {
 protected:
  void drive(const SimulatedDrive::Options& options = {}) {
    SimulatedDrive drive(8, options);
    for (int frame = 0; frame < kReadFrames; ++frame) {
      FrameMeasurements measurements = *drive.measure(frame);
      change_(frame, measurements);
      graph_.add(measurements);
    }
  }

  SE3 camera(FrameId frame) const { return graph_.solver().pose(graph_.frames().at(frame).x); }
  const ObjectTrack& track(int vehicle) const { return graph_.tracks().at(SimulatedDrive::track(vehicle)); }
  SE3 anchor(int vehicle) const { return graph_.solver().pose(track(vehicle).shared); }
  SE3 poseInTrack(int vehicle, FrameId frame) const {
    return graph_.solver().pose(track(vehicle).records.at(frame).pose);
  }
  /// Throws when there are none.
  ObjectCovariances covarianceOf(int vehicle, FrameId frame) const {
    return reader_.covariances(frame).objects.at(SimulatedDrive::track(vehicle));
  }
  ObjectEstimate estimateOf(int vehicle, FrameId frame) const {
    const auto objects = reader_.read(frame).objects;
    const auto found = std::ranges::find(objects, SimulatedDrive::track(vehicle), &ObjectEstimate::track);
    EXPECT_NE(found, objects.end());
    return *found;
  }

  std::function<void(int, FrameMeasurements&)> change_ = [](int, FrameMeasurements&) {};
  AnchoredPoseGraph graph_{PoseGraphParams{}};
  EstimateReader reader_{graph_};
};

TEST_F(EstimateReaderTest, ReadsPosesAsTheyAreInTheGraph) {
  change_ = [](int frame, FrameMeasurements& m) {
    m.head.status = frame == 3 ? FrameStatus::kLost : FrameStatus::kGood;
  };
  drive();
  constexpr double kSame = 1e-12;  // but for the rounding of a rotation that is put back onto SO(3)
  for (const auto& [frame, record] : graph_.frames()) {
    const FrameEstimate estimate = reader_.read(frame);
    EXPECT_EQ(estimate.head.frame, frame);
    EXPECT_EQ(estimate.head.stamp, record.head.stamp);
    EXPECT_EQ(estimate.head.status, frame.value == 3 ? FrameStatus::kLost : FrameStatus::kGood);
    EXPECT_THAT(estimate.T_world_cam, IsNearPose(camera(frame), kSame));
    EXPECT_TRUE(std::ranges::is_sorted(estimate.objects, {}, &ObjectEstimate::track));
    for (const ObjectEstimate& object : estimate.objects) {
      const int vehicle = static_cast<int>(object.track.value - SimulatedDrive::track(0).value);
      EXPECT_THAT(object.T_world_body, IsNearPose(anchor(vehicle) * poseInTrack(vehicle, frame), kSame));
      EXPECT_EQ(object.points, 40);
    }
  }
}

TEST_F(EstimateReaderTest, AFrameHasTheObjectsThatWereObservedInIt) {
  SimulatedDrive::Options options;
  options.vehicles[1].last_frame = 7;
  drive(options);
  const auto tracks = [&](int frame) {
    std::vector<std::int64_t> ids;
    for (const auto& object : reader_.read({frame}).objects) ids.push_back(object.track.value - 100);
    return ids;
  };
  EXPECT_THAT(tracks(4), testing::ElementsAre(0, 1));  // vehicle 2 comes in frame 5
  EXPECT_THAT(tracks(7), testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(tracks(8), testing::ElementsAre(0, 2));
}

TEST_F(EstimateReaderTest, AnObjectsCovarianceIsThatOfItsPoseSeenFromTheCamera) {
  drive();
  for (const FrameId frame : {FrameId{0}, FrameId{6}, kLast}) {
    const SE3 x = camera(frame), a = anchor(0), z = poseInTrack(0, frame);
    const auto error = [&](const SE3& x_now, const SE3& a_now, const SE3& z_now) {
      return ((x.inverse() * a * z).inverse() * (x_now.inverse() * a_now * z_now)).log();
    };
    Eigen::MatrixXd J(6, 18);
    J << numericJacobian([&](const SE3& T) { return error(T, a, z); }, x),
        numericJacobian([&](const SE3& T) { return error(x, T, z); }, a),
        numericJacobian([&](const SE3& T) { return error(x, a, T); }, z);
    const std::array variables{graph_.frames().at(frame).x, track(0).shared, track(0).records.at(frame).pose};
    const Eigen::MatrixXd expected = J * *graph_.solver().jointCovariance(variables) * J.transpose();
    constexpr double kTolerance = 1e-6;  // central differences, on variances of the weak anchor's 1e4 m^2 at most
    EXPECT_THAT(covarianceOf(0, frame).T_cam_body, IsNear(expected, kTolerance * (1 + expected.norm())));
  }
}

TEST_F(EstimateReaderTest, TheCamerasCovarianceIsThatOfItsMotionOverTenFrames) {
  drive();
  const FrameId before{kLast.value - kCameraCovarianceFrames};
  const SE3 x_before = camera(before), x_now = camera(kLast);
  const auto error = [&](const SE3& from, const SE3& to) {
    return ((x_before.inverse() * x_now).inverse() * (from.inverse() * to)).log();
  };
  Eigen::MatrixXd J(6, 12);
  J << numericJacobian([&](const SE3& T) { return error(T, x_now); }, x_before),
      numericJacobian([&](const SE3& T) { return error(x_before, T); }, x_now);
  const std::array variables{graph_.frames().at(before).x, graph_.frames().at(kLast).x};
  const Eigen::MatrixXd expected = J * *graph_.solver().jointCovariance(variables) * J.transpose();
  constexpr double kTolerance = 1e-8;  // central differences
  EXPECT_THAT(reader_.covariances(kLast).camera.motion.value(), IsNear(expected, kTolerance));
}

TEST_F(EstimateReaderTest, TheCamerasMotionHasNoCovarianceInItsFirstTenFrames) {
  drive();
  EXPECT_FALSE(reader_.covariances({kCameraCovarianceFrames - 1}).camera.motion);
  EXPECT_TRUE(reader_.covariances({kCameraCovarianceFrames}).camera.motion);
}

/// A step is surer than the way that it is part of.
TEST_F(EstimateReaderTest, TheCamerasMotionIsToldOverAsManyFramesAsAskedFor) {
  drive();
  const EstimateReader by_step(graph_, 1), by_twelve(graph_, 12);
  EXPECT_TRUE(by_step.covariances({1}).camera.motion);
  EXPECT_FALSE(by_twelve.covariances({11}).camera.motion);
  const auto trace = [&](const EstimateReader& reader) { return reader.covariances(kLast).camera.motion->trace(); };
  EXPECT_LT(trace(by_step), trace(reader_));
  EXPECT_LT(trace(reader_), trace(by_twelve));
}

/// Retirement leaves what the frames that are gone knew of those that are there.
TEST_F(EstimateReaderTest, TheCamerasPoseKeepsItsCovarianceWhenTheStartHasRetired) {
  drive();
  const std::array start_and_now{graph_.frames().at({0}).x, graph_.frames().at(kLast).x};
  const Eigen::MatrixXd joint = *graph_.solver().jointCovariance(start_and_now);
  const Matrix6d pose = reader_.covariances(kLast).camera.pose.value();
  constexpr double kTolerance = 1e-9;
  EXPECT_THAT(pose, IsNear(joint.bottomRightCorner<6, 6>(), kTolerance));
  EXPECT_LT(reader_.covariances({0}).camera.pose->norm(), 2e-6) << "the first pose is the world, to a millimeter";
  EXPECT_GT(pose.norm(), 1e-4);
  for (int i = 0; i < 8; ++i) graph_.retireOldest();
  EXPECT_THAT(reader_.covariances(kLast).camera.pose.value(), IsNear(pose, 1e-3 * pose.norm()));
}

/// The neighbor in time is the frame before; the first frame of a track takes the frame after.
TEST_F(EstimateReaderTest, SigmasOfSpeedAndYawRateFollowFromTheTwoPosesTheyAreMadeOf) {
  drive();
  for (const auto& [frame, other] : {std::pair(kLast, FrameId{kLast.value - 1}), std::pair(FrameId{0}, FrameId{1})}) {
    const SE3 z_now = poseInTrack(0, frame), z_other = poseInTrack(0, other);
    const double dt_s =
        std::abs(secondsBetween(graph_.frames().at(other).head.stamp, graph_.frames().at(frame).head.stamp));
    const auto speed = [&](const SE3& from, const SE3& to) {
      return Eigen::Matrix<double, 1, 1>((from.inverse() * to).log().head<3>().norm() / dt_s);
    };
    const auto yaw_rate = [&](const SE3& from, const SE3& to) {
      return Eigen::Matrix<double, 1, 1>((from.inverse() * to).log()[5] / dt_s);
    };
    const std::array variables{track(0).records.at(frame).pose, track(0).records.at(other).pose};
    const auto sigmaOf = [&](const auto& rate) {
      Eigen::MatrixXd J(1, 12);
      J << numericJacobian([&](const SE3& T) { return rate(z_other, T); }, z_now),
          numericJacobian([&](const SE3& T) { return rate(T, z_now); }, z_other);
      return std::sqrt((J * *graph_.solver().jointCovariance(variables) * J.transpose())(0, 0));
    };
    constexpr double kTolerance = 1e-6;  // central differences, divided by dt
    const ObjectCovariances object = covarianceOf(0, frame);
    EXPECT_NEAR(object.speed_sigma_mps.value(), sigmaOf(speed), kTolerance) << frame.value;
    EXPECT_NEAR(object.yaw_rate_sigma_radps.value(), sigmaOf(yaw_rate), kTolerance) << frame.value;
  }
}

TEST_F(EstimateReaderTest, AnObjectSeenOnceHasTheFrontEndsVelocityAndAWideSigma) {
  const Eigen::Vector3d velocity_cam_mps{0.5, 0, 9};
  change_ = [&](int frame, FrameMeasurements& m) {
    std::erase_if(m.objects, [&](const auto& seen) {
      return seen.track == SimulatedDrive::track(0) ? frame != 10 : frame < 12;  // the others serve as a contrast
    });
    for (ObjectObservation& seen : m.objects) {
      seen.motion.reset();
      seen.velocity_cam_mps = velocity_cam_mps;
    }
  };
  drive();
  graph_.keep({10}, reader_.covariances({10}));
  graph_.keep(kLast, reader_.covariances(kLast));
  const ObjectEstimate once = estimateOf(0, {10});
  EXPECT_TRUE(once.velocity_world_mps.isApprox(camera({10}).rotation() * velocity_cam_mps));
  EXPECT_EQ(once.speed_sigma_mps, 10.0);
  EXPECT_EQ(once.yaw_rate_radps, 0);
  EXPECT_EQ(once.yaw_rate_sigma_radps, 0.3);
  EXPECT_TRUE(once.covariance);
  EXPECT_LT(estimateOf(1, kLast).speed_sigma_mps, 10.0);
}

TEST_F(EstimateReaderTest, VelocityAndYawRateAreExactOnAnArcOfConstantSpeed) {
  SimulatedDrive::Options exact;
  exact.encounter_sigma_m = exact.motion_sigma_m = exact.odometry_sigma_m = 1e-5;
  exact.encounter_sigma_rad = exact.motion_sigma_rad = exact.odometry_sigma_rad = 1e-6;
  drive(exact);
  const SimulatedDrive truth(8, exact);
  const int turning = 1;  // at 6 m/s and 0.15 rad/s
  for (const int frame : {0, 7, kReadFrames - 1}) {
    const Eigen::Vector3d expected = truth.object(turning, frame).rotation() * Eigen::Vector3d(6, 0, 0);
    constexpr double kNoise_mps = 2e-3;  // 1e-5 m over 0.1 s, with the camera's and a margin
    EXPECT_THAT(estimateOf(turning, {frame}).velocity_world_mps, IsNear(expected, kNoise_mps)) << "frame " << frame;
    constexpr double kNoise_radps = 2e-4;  // 1e-6 rad over 0.1 s, likewise
    EXPECT_NEAR(estimateOf(turning, {frame}).yaw_rate_radps, 0.15, kNoise_radps) << "frame " << frame;
  }
}

TEST_F(EstimateReaderTest, CovariancesStandInTheEstimatesOnceTheGraphKeepsThem) {
  drive();
  EXPECT_FALSE(reader_.read(kLast).camera_covariances.motion);
  EXPECT_FALSE(reader_.read(kLast).camera_covariances.pose);
  EXPECT_THAT(reader_.read(kLast).objects, Each(Field(&ObjectEstimate::covariance, std::nullopt)));
  const FrameCovariances covariances = reader_.covariances(kLast);
  graph_.keep(kLast, covariances);
  const FrameEstimate estimate = reader_.read(kLast);
  EXPECT_EQ(estimate.camera_covariances.motion, covariances.camera.motion);
  EXPECT_EQ(estimate.camera_covariances.pose, covariances.camera.pose);
  ASSERT_EQ(estimate.objects.size(), covariances.objects.size());
  for (const ObjectEstimate& object : estimate.objects) {
    const ObjectCovariances& computed = covariances.objects.at(object.track);
    EXPECT_EQ(object.covariance, computed.T_cam_body);
    EXPECT_EQ(object.speed_sigma_mps, computed.speed_sigma_mps);
    EXPECT_EQ(object.yaw_rate_sigma_radps, computed.yaw_rate_sigma_radps);
    EXPECT_FALSE(object.acceleration) << "a graph without twists tells none";
  }
}

TEST_F(EstimateReaderTest, AnAccelerationIsTheOneThatTheGraphKeeps) {
  drive();
  FrameCovariances covariances = reader_.covariances(kLast);
  covariances.objects.at(SimulatedDrive::track(0)).acceleration = {
      .along_mps2 = -2, .along_sigma_mps2 = 0.5, .yaw_radps2 = 0.1, .yaw_sigma_radps2 = 0.05};
  graph_.keep(kLast, covariances);
  const auto told = estimateOf(0, kLast).acceleration;
  ASSERT_TRUE(told);
  EXPECT_EQ(told->along_mps2, -2);
  EXPECT_EQ(told->along_sigma_mps2, 0.5);
  EXPECT_EQ(told->yaw_radps2, 0.1);
  EXPECT_EQ(told->yaw_sigma_radps2, 0.05);
  EXPECT_FALSE(estimateOf(1, kLast).acceleration);
}

TEST_F(EstimateReaderTest, AnObjectWhosePoseIsNotInTheGraphHasNoCovarianceAndThePoseThatWasSeen) {
  change_ = [](int frame, FrameMeasurements& m) {
    for (ObjectObservation& seen : m.objects)
      if (frame == 0) seen.state = ObjectState::kPredicted;  // with nothing to predict from
  };
  drive();
  EXPECT_TRUE(reader_.covariances({0}).objects.empty());
  const ObjectEstimate object = estimateOf(0, {0});
  EXPECT_EQ(object.state, ObjectState::kPredicted);
  constexpr double kSame = 1e-12;
  EXPECT_THAT(object.T_world_body, IsNearPose(camera({0}) * track(0).records.at({0}).seen.T_cam_body, kSame));
}

TEST_F(EstimateReaderTest, APoseThatLeftTheWindowStillGivesTheVelocityOfTheNext) {
  drive();
  const Eigen::Vector3d before = estimateOf(0, {1}).velocity_world_mps;
  graph_.retireOldest();
  constexpr double kRetirement_mps = 1e-6;  // the pose is frozen at its estimate
  EXPECT_THAT(estimateOf(0, {1}).velocity_world_mps, IsNear(before, kRetirement_mps));
}

}  // namespace
}  // namespace motorcade
