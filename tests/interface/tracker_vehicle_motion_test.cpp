#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"

/// The vehicle's own motion, by the public interface.
namespace motorcade {
namespace {

using testing::HasSubstr;

/// A drive of which nothing is seen after its first frames.
class DarkDrive : public testing::Test {
 protected:
  static constexpr std::size_t kDark = 20;

  DarkDrive() {
    const std::vector<Result> seen = track(drive_);
    const Result &before = seen[seen.size() - 2], &last = seen.back();
    const double dt_s = 1e-9 * static_cast<double>(last.stamp_ns - before.stamp_ns);
    speed_mps_ = (last.T_world_cam[11] - before.T_world_cam[11]) / dt_s;
    seen_ = drive_.frames.size();
    const std::vector<std::uint8_t> black(drive_.frames.front().left.size(), 0);
    for (std::size_t i = 1; i <= kDark; ++i)
      drive_.frames.push_back({black, black, last.stamp_ns + static_cast<std::int64_t>(i) * kPeriod_ns});
  }

  /// Samples of the drive at the speed of its end, ten a frame.
  std::vector<VehicleMotion> steady(double speed_mps) const {
    std::vector<VehicleMotion> samples;
    const std::int64_t end_ns = drive_.frames.back().stamp_ns;
    for (std::int64_t stamp_ns = drive_.frames.front().stamp_ns; stamp_ns <= end_ns; stamp_ns += kPeriod_ns / 10)
      samples.push_back({.stamp_ns = stamp_ns, .speed_mps = speed_mps});
    return samples;
  }
  std::vector<Result> follow(const std::vector<VehicleMotion>& samples, const Tracker::Options& options = replay()) {
    Tracker tracker(drive_.camera, options);
    for (const VehicleMotion& sample : samples)
      EXPECT_EQ(tracker.push_motion(sample).status, Tracker::Push::Status::kAccepted);
    std::jthread producer([&] {
      for (std::size_t index = 0; index < drive_.frames.size(); ++index) tracker.push(drive_.pair(index));
      tracker.close();
    });
    return rest(tracker);
  }
  double wayInTheDark_m(const std::vector<Result>& results) const {
    return results.back().T_world_cam[11] - results[seen_ - 1].T_world_cam[11];
  }

  static constexpr std::int64_t kPeriod_ns = 100'000'000;
  DriveInMemory drive_ = readDrive(MOTORCADE_TINY_SEQUENCE);
  double speed_mps_ = 0;
  std::size_t seen_ = 0;
};

TEST_F(DarkDrive, TheCameraGoesOnWhereTheVehicleDoes) {
  ASSERT_GT(speed_mps_, 3);
  const std::vector<Result> told = follow(steady(speed_mps_));
  ASSERT_EQ(told.size(), drive_.frames.size());
  EXPECT_NEAR(wayInTheDark_m(told), 2 * speed_mps_, 0.1 * speed_mps_);
  EXPECT_LT(wayInTheDark_m(follow({})), 1.6 * speed_mps_);
  EXPECT_EQ(told.back().status, Result::Status::kLost) << "by its images";
  EXPECT_EQ(told.back().segment, 0);
  ASSERT_TRUE(told.back().pose_covariance);
  EXPECT_LT((*told.back().pose_covariance)[14], 4) << "2 m ahead, where nothing is known it is 3 m after a second";
}

TEST_F(DarkDrive, ResultsDoNotDependOnTheOrderOfSamples) {
  std::vector<VehicleMotion> samples = steady(speed_mps_);
  const std::vector<Result> in_order = follow(samples);
  std::ranges::reverse(samples);
  const std::vector<Result> reversed = follow(samples);
  ASSERT_EQ(in_order.size(), reversed.size());
  for (std::size_t i = 0; i < in_order.size(); ++i)
    EXPECT_EQ(ResultBytes::of(in_order[i]), ResultBytes::of(reversed[i])) << i;
}

TEST_F(DarkDrive, AnotherUnitIsToldAndLeftOut) {
  std::mutex mutex;
  std::vector<std::string> said;
  Tracker::Options options = replay();
  options.log = [&](Tracker::LogLevel, const std::string& text) {
    const std::lock_guard lock(mutex);
    said.push_back(text);
  };
  const double way_m = wayInTheDark_m(follow(steady(3.6 * speed_mps_), options));
  EXPECT_LT(way_m, 1.6 * speed_mps_);
  EXPECT_THAT(said, testing::Contains(testing::AllOf(HasSubstr("contradicts the camera"), HasSubstr("km/h"))));
}

TEST(PushMotion, WhatIsNoMotionIsRejected) {
  Tracker tracker(blankDrive(1).camera, replay());
  const auto why = [&](const VehicleMotion& motion) -> std::string {
    const auto outcome = tracker.push_motion(motion);
    EXPECT_EQ(outcome.status == Tracker::Push::Status::kRejected, *outcome.why != '\0');
    return outcome.why;
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(why({.stamp_ns = 5, .speed_mps = -3, .yaw_rate_radps = 0.2}), "");
  EXPECT_THAT(why({.speed_mps = kNone}), HasSubstr("speed"));
  EXPECT_THAT(why({.speed_mps = 1e4}), HasSubstr("150 m/s"));
  EXPECT_THAT(why({.yaw_rate_radps = kNone}), HasSubstr("yaw rate"));
  EXPECT_THAT(why({.speed_sigma_mps = -1}), HasSubstr("standard deviation"));
  EXPECT_THAT(why({.yaw_rate_sigma_radps = kNone}), HasSubstr("standard deviation"));
  EXPECT_THAT(why({.stamp_ns = std::numeric_limits<std::int64_t>::min()}), HasSubstr("stamp"));
  EXPECT_EQ(tracker.counts().pushed, 0) << "samples are no pairs";
  tracker.close();
  EXPECT_THAT(why({}), HasSubstr("closed"));
}

TEST(PushMotion, ManySamplesBetweenTwoPairsAreNoHarm) {
  const DriveInMemory drive = blankDrive(3);
  Tracker tracker(drive.camera, replay());
  for (std::int64_t i = 0; i < 20'000; ++i) tracker.push_motion({.stamp_ns = 10'000 * i, .speed_mps = 1});
  for (std::size_t index = 0; index < drive.frames.size(); ++index) tracker.push(drive.pair(index));
  tracker.close();
  EXPECT_EQ(rest(tracker).size(), 3U);
}

}  // namespace
}  // namespace motorcade
