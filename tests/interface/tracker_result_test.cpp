#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/interface/result_truth.hpp"
#include "tests/interface/tracked_drive.hpp"

/// Tests the results on the camera, however they come, on a drive of which the truth is known.
namespace motorcade {
namespace {

class Results : public testing::Test {
 protected:
  static constexpr double kPeriod_s = 0.1;
  const DriveInMemory drive_ = readDrive(MOTORCADE_SMALL_SEQUENCE);
};

TEST_F(Results, AreTheSameBitsForAnyNumberOfThreadsAndHoweverTheyAreTaken) {
  Tracker::Options masks = replay(1);
  masks.masks = true;
  const auto expected = bytesOf(track(drive_, masks));
  ASSERT_EQ(expected.size(), drive_.frames.size());
  masks.threads = 2;
  EXPECT_EQ(bytesOf(track(drive_, masks)), expected);
  masks.settings = "pipeline.frames_in_flight = 1";
  EXPECT_EQ(bytesOf(track(drive_, masks)), expected);

  std::vector<Result> polled, called;
  Tracker by_poll(drive_.camera, masks), by_call(drive_.camera, masks);
  by_call.on_result([&](Result result) { called.push_back(std::move(result)); });
  for (std::size_t i = 0; i < drive_.frames.size(); ++i) {
    by_poll.push(drive_.pair(i));
    by_call.push(drive_.pair(i));
    while (auto result = by_poll.poll()) polled.push_back(std::move(*result));
  }
  by_poll.close();
  by_call.close();
  while (!by_poll.done())
    if (auto result = by_poll.poll()) polled.push_back(std::move(*result));
  while (!by_call.done()) std::this_thread::yield();
  EXPECT_EQ(bytesOf(polled), expected);
  EXPECT_EQ(bytesOf(called), expected);
}

TEST_F(Results, TellTheCamerasMotion) {
  const Truth truth = readTruth(MOTORCADE_SMALL_SEQUENCE);
  const std::vector<Result> results = track(drive_);
  for (std::size_t i = 1; i < results.size(); ++i) {
    const Transform T_before_now = truth.T_world_cam[i - 1].inverse() * truth.T_world_cam[i];
    const Eigen::Map<const Eigen::Matrix<double, 6, 1>> velocity(results[i].velocity.data());
    EXPECT_EQ(results[i].status, Result::Status::kGood);
    EXPECT_EQ(results[i].frame, static_cast<std::int64_t>(i));
    EXPECT_EQ(results[i].stamp_ns, drive_.frames[i].stamp_ns);
    EXPECT_GT(results[i].latency_ms, 0);
    const Eigen::Vector3d error_mps = velocity.head<3>() - T_before_now.topRightCorner<3, 1>() / kPeriod_s;
    EXPECT_LT(error_mps.norm(), 0.3) << "frame " << i;  // 3 cm in a period, half a pixel of a near point
    const auto covariance = squareOf(results[i].velocity_covariance);
    EXPECT_LT(error_mps.norm(), 5 * std::sqrt(covariance.topLeftCorner<3, 3>().trace()));
    const Transform drift = transformOf(results[i].T_world_cam).inverse() * truth.T_world_cam[i];
    EXPECT_LT((drift.topRightCorner<3, 1>().norm()), 0.5);
  }
  EXPECT_TRUE(results.back().motion_covariance);
  for (const Result& result : results) ASSERT_TRUE(result.pose_covariance);
  EXPECT_GT(squareOf(*results.back().pose_covariance).trace(), 10 * squareOf(*results[0].pose_covariance).trace());
}

/// The settings count before what the camera tells of itself.
TEST_F(Results, AreLessSureWhereTheCalibrationIs) {
  const auto variance = [&](const std::optional<Camera::Sigmas>& sigmas, const std::string& settings = "") {
    DriveInMemory drive = drive_;
    drive.camera.sigmas = sigmas;
    Tracker::Options options = replay();
    options.settings = settings;
    return squareOf(*track(drive, options).back().pose_covariance)(2, 2);
  };
  const Camera::Sigmas exact{0, 0, 0, 0, 0}, typical;
  EXPECT_LT(2 * variance(exact), variance(typical));
  EXPECT_EQ(variance({}), variance(typical));
  EXPECT_GT(variance(Camera::Sigmas{.focal = 0.05}), 4 * variance(typical));
  EXPECT_GT(variance(exact, "calibration.focal = 0.05"), 4 * variance(typical));
}

TEST_F(Results, TellHowSureTheMotionIsOverAsManyFramesAsAskedFor) {
  for (const char* kind : {"joint", "filter", "filter_map", "pose_graph"}) {
    Tracker::Options options = replay();
    options.settings = std::string("backend.kind = '") + kind + "'";
    const Result by_ten = track(drive_, options).back();
    options.covariance_frames = 1;
    const std::vector<Result> by_step = track(drive_, options);
    EXPECT_FALSE(by_step[0].motion_covariance) << kind;
    EXPECT_TRUE(by_step[1].motion_covariance) << kind;
    EXPECT_LT(squareOf(*by_step.back().motion_covariance).trace(), squareOf(*by_ten.motion_covariance).trace()) << kind;
  }
}

/// Nothing is known of the first frame's motion: it is not surely zero.
TEST_F(Results, AreNotSureOfAMotionThatNothingTells) {
  EXPECT_GT(track(drive_).front().velocity_covariance[35], 0.1);
  EXPECT_GT(track(drive_).front().velocity_covariance[0], 100);
}

/// Frames in the dark are lost; the motion across them is measured as a whole.
TEST_F(Results, GiveTheMeanVelocityAcrossFramesThatWereNotSeen) {
  const Truth truth = readTruth(MOTORCADE_SMALL_SEQUENCE);
  DriveInMemory dark = drive_;
  for (const std::size_t i : {7, 8})
    std::ranges::fill(dark.frames[i].left, 0), std::ranges::fill(dark.frames[i].right, 0);
  const std::vector<Result> results = track(dark);
  for (const std::size_t i : {7, 8}) {
    EXPECT_EQ(results[i].status, Result::Status::kLost);
    EXPECT_EQ(results[i].cause, Result::Cause::kNoPoints);
    EXPECT_FALSE(results[i].problem.empty() && results[i].cause == Result::Cause::kNone);
    EXPECT_GE(results[i].velocity_covariance[0], 1);
  }
  ASSERT_EQ(results[9].status, Result::Status::kGood);
  EXPECT_EQ(results[9].cause, Result::Cause::kAfterGap);
  const Eigen::Vector3d mean_mps =
      (truth.T_world_cam[6].inverse() * truth.T_world_cam[9]).topRightCorner<3, 1>() / (3 * kPeriod_s);
  const Eigen::Vector3d measured_mps(results[9].velocity.data());
  EXPECT_LT((measured_mps - mean_mps).norm(), 0.15);  // 4 cm in three periods
}

template <std::size_t kCount>
void expectCovariance(const std::array<double, kCount>& rows) {
  const auto covariance = squareOf(rows);
  const double scale = covariance.norm();
  EXPECT_TRUE(covariance.allFinite());
  EXPECT_GT(scale, 0);
  EXPECT_LT((covariance - covariance.transpose()).norm(), 1e-9 * scale);
  const Eigen::MatrixXd symmetric = 0.5 * (covariance + covariance.transpose());
  EXPECT_GT(symmetric.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-9 * scale);
}

TEST_F(Results, HaveSymmetricPositiveSemidefiniteCovariances) {
  DriveInMemory dark = drive_;
  std::ranges::fill(dark.frames[8].left, 0), std::ranges::fill(dark.frames[8].right, 0);
  for (const auto axes : {Tracker::Axes::kOptical, Tracker::Axes::kRep103}) {
    Tracker::Options options = replay();
    options.axes = axes;
    int objects = 0;
    for (const Result& result : track(dark, options)) {
      expectCovariance(result.velocity_covariance);
      if (result.motion_covariance) expectCovariance(*result.motion_covariance);
      if (result.pose_covariance) expectCovariance(*result.pose_covariance);
      for (const Result::Object& object : result.objects) {
        ++objects;
        expectCovariance(object.velocity_covariance);
        if (object.covariance) expectCovariance(*object.covariance);
      }
    }
    EXPECT_GT(objects, 0);
  }
}

TEST_F(Results, InRep103AxesAreTheOpticalOnesTurned) {
  Transform T_rep_cam = Transform::Identity();
  T_rep_cam.topLeftCorner<3, 3>() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d R = T_rep_cam.topLeftCorner<3, 3>();
  Eigen::Matrix<double, 6, 6> R6 = Eigen::Matrix<double, 6, 6>::Zero();
  R6.topLeftCorner<3, 3>() = R6.bottomRightCorner<3, 3>() = R;
  constexpr double kTol = 1e-12;  // of sums of a few products with 0 and 1

  Tracker::Options options = replay();
  const std::vector<Result> optical = track(drive_, options);
  options.axes = Tracker::Axes::kRep103;
  const std::vector<Result> rep = track(drive_, options);
  ASSERT_EQ(optical.size(), rep.size());
  int objects = 0;
  for (std::size_t i = 0; i < rep.size(); ++i) {
    const Transform T_world_cam = T_rep_cam * transformOf(optical[i].T_world_cam) * T_rep_cam.inverse();
    EXPECT_TRUE(transformOf(rep[i].T_world_cam).isApprox(T_world_cam, kTol));
    const Eigen::Matrix<double, 6, 1> velocity =
        R6 * Eigen::Map<const Eigen::Matrix<double, 6, 1>>(optical[i].velocity.data());
    EXPECT_TRUE((Eigen::Map<const Eigen::Matrix<double, 6, 1>>(rep[i].velocity.data()).isApprox(velocity, kTol)) ||
                i == 0);
    EXPECT_TRUE(squareOf(rep[i].velocity_covariance)
                    .isApprox(R6 * squareOf(optical[i].velocity_covariance) * R6.transpose(), kTol));
    for (const auto covariance : {&Result::motion_covariance, &Result::pose_covariance}) {
      if (!(optical[i].*covariance)) continue;
      EXPECT_TRUE(
          squareOf(*(rep[i].*covariance)).isApprox(R6 * squareOf(*(optical[i].*covariance)) * R6.transpose(), kTol));
    }
    ASSERT_EQ(optical[i].objects.size(), rep[i].objects.size());
    for (std::size_t k = 0; k < rep[i].objects.size(); ++k, ++objects) {
      const Result::Object &a = optical[i].objects[k], &b = rep[i].objects[k];
      EXPECT_TRUE(transformOf(b.T_cam_body).isApprox(T_rep_cam * transformOf(a.T_cam_body), kTol));
      EXPECT_TRUE(transformOf(b.T_world_body).isApprox(T_rep_cam * transformOf(a.T_world_body), kTol));
      EXPECT_TRUE(vectorOf(b.velocity_world_mps).isApprox(R * vectorOf(a.velocity_world_mps), kTol));
      EXPECT_TRUE(squareOf(b.velocity_covariance).isApprox(R * squareOf(a.velocity_covariance) * R.transpose(), kTol));
      EXPECT_EQ(a.covariance, b.covariance);  // of the body, whose axes stay
      EXPECT_EQ(a.box_size_m, b.box_size_m);
      EXPECT_EQ(a.box_center_body_m, b.box_center_body_m);
      EXPECT_EQ(a.yaw_rate_radps, b.yaw_rate_radps);
      EXPECT_EQ(a.acceleration.has_value(), b.acceleration.has_value());
      EXPECT_EQ(a.acceleration.value_or(Result::Acceleration{}).along_mps2,
                b.acceleration.value_or(Result::Acceleration{}).along_mps2);
    }
  }
  EXPECT_GT(objects, 0);
  // A car that drives ahead has x ahead in both its own axes and the world's.
  EXPECT_GT(rep.back().objects.front().velocity_world_mps[0], 5);
  EXPECT_GT(rep.back().objects.front().T_cam_body[0], 0.9);
}

}  // namespace
}  // namespace motorcade
