#include "frontend/motion/vehicle_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "frontend/motion/camera_odometry.hpp"
#include "tests/frontend/motion/simulated_vehicle.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

/// The vehicle's own motion where the camera sees and where it does not.
namespace motorcade {
namespace {

using test::SimulatedVehicle;

UncertainMotion asMeasured(const SE3& T_then_now) { return {T_then_now, 1e-6 * Matrix6d::Identity()}; }

/// The samples up to a frame's time, as they come with it.
class Inputs {
 public:
  explicit Inputs(std::vector<VehicleMotionSample> samples) : samples_(std::move(samples)) {}
  FrameInputs upTo(Timestamp stamp) {
    for (; next_ < samples_.size() && samples_[next_].stamp <= stamp; ++next_) log_->add(samples_[next_]);
    return {.ignored = {}, .vehicle_motion = log_, .vehicle_samples = next_};
  }

 private:
  std::vector<VehicleMotionSample> samples_;
  std::size_t next_ = 0;
  std::shared_ptr<VehicleMotionLog> log_ = std::make_shared<VehicleMotionLog>();
};

/// Sensors that are wrong from one frame on, and their verdict.
class Sensors {
 public:
  template <class Spoil>
  Sensors(int frames, const Spoil& spoil) : drive_(11, frames, {}) {
    auto samples = drive_.samples;
    for (auto& sample : samples) spoil(sample);
    Inputs inputs(samples);
    for (int frame = 0; frame < frames; ++frame) {
      odometry_.hear(inputs.upTo(drive_.stampOf(frame)), drive_.stampOf(frame));
      if (frame > 0)
        odometry_.compare(drive_.stampOf(frame - 1), drive_.stampOf(frame),
                          asMeasured(drive_.motion(frame - 1, frame)));
      believed_.push_back(odometry_.sensors().value_or(VehicleSensors{}).believed);
    }
  }
  const std::vector<bool>& believed() const { return believed_; }
  VehicleSensors found() const { return *odometry_.sensors(); }

 private:
  SimulatedVehicle drive_;
  VehicleOdometry odometry_;
  std::vector<bool> believed_;
};

int framesWithoutBelief(const Sensors& sensors) {
  return static_cast<int>(std::ranges::count(sensors.believed(), false));
}

TEST(VehicleOdometry, SensorsWithUsualFaultsAreBelievedAllTheTime) {
  EXPECT_EQ(framesWithoutBelief(Sensors(200, [](auto&) {})), 0);
}

TEST(VehicleOdometry, WhatLiesFromTheStartIsLeftOutWithinAFewFrames) {
  const auto expectLeftOut = [](const char* what, const auto& spoil) {
    const Sensors sensors(60, spoil);
    EXPECT_FALSE(sensors.believed().back()) << what;
    EXPECT_GE(framesWithoutBelief(sensors), 55) << what;
  };
  expectLeftOut("km/h", [](auto& sample) { sample.speed_mps *= 3.6; });
  expectLeftOut("dead", [](auto& sample) { sample.speed_mps = 0; });
  expectLeftOut("backwards", [](auto& sample) { sample.speed_mps *= -1; });
  expectLeftOut("turning", [](auto& sample) { sample.yaw_rate_radps += 0.3; });
}

TEST(VehicleOdometry, AWheelThatSpinsForAWhileIsLeftOutMeanwhile) {
  const Sensors sensors(140, [](auto& sample) {
    const double time_s = static_cast<double>(sample.stamp.ns) * 1e-9;
    if (time_s > 5 && time_s < 7) sample.speed_mps += 5;
  });
  EXPECT_TRUE(sensors.believed()[50]);
  EXPECT_FALSE(sensors.believed()[60]);
  EXPECT_TRUE(sensors.believed()[110]);
  EXPECT_NEAR(sensors.found().speed_scale, 1 / 1.02, 0.01) << "nothing was learned from it";
}

TEST(VehicleOdometry, WhatIsDisputedForFiveSecondsIsLeftOut) {
  VehicleOdometry odometry;
  const SimulatedVehicle drive(1, 20, {});
  Inputs inputs(drive.samples);
  odometry.hear(inputs.upTo(drive.stampOf(20)), drive.stampOf(20));
  for (int i = 0; i < 49; ++i) odometry.dispute();
  EXPECT_TRUE(odometry.motion(drive.stampOf(3), drive.stampOf(5)));
  odometry.dispute();
  EXPECT_FALSE(odometry.motion(drive.stampOf(3), drive.stampOf(5)));
}

/// A camera that sees the first frames of a drive, and nothing in those after.
class InTheDark : public testing::Test {
 protected:
  static constexpr int kSeen = 40, kDark = 30;

  void drive(std::vector<VehicleMotionSample> samples) {
    Inputs inputs(std::move(samples));
    for (int frame = 0; frame < kSeen + kDark; ++frame) {
      const Timestamp stamp = drive_.stampOf(frame);
      odometry_.hear(inputs.upTo(stamp), stamp);
      if (frame >= kSeen)
        steps_.push_back(odometry_.passOver(stamp));
      else
        odometry_.add(stamp, {.T_seen_now = frame == 0 ? SE3{} : drive_.motion(frame - 1, frame),
                              .covariance = 1e-6 * Matrix6d::Identity(),
                              .inliers = {}});
    }
  }
  SE3 steppedTo(int frames) const {
    SE3 T_seen_now;
    for (int i = 0; i < frames; ++i) T_seen_now = T_seen_now * steps_[static_cast<std::size_t>(i)].T_previous_now;
    return T_seen_now;
  }

  const SimulatedVehicle drive_{21, kSeen + kDark, {}};
  CameraOdometry odometry_{{}, test::kRig};
  std::vector<Odometry> steps_;
};

TEST_F(InTheDark, TheCameraGoesOnAsTheVehicleDoes) {
  drive(drive_.samples);
  const Vector6d error = (drive_.motion(kSeen - 1, kSeen + kDark - 1).inverse() * steppedTo(kDark)).log();
  EXPECT_LT(error.head<3>().norm(), 0.5);  // of 30 m
  EXPECT_TRUE(odometry_.motionKnown(drive_.stampOf(kSeen + kDark)));
}

/// Samples that are wrong in the last six frames before the dark.
template <class Spoil>
std::vector<VehicleMotionSample> spoiledInto(std::vector<VehicleMotionSample> samples, int seen, const Spoil& spoil) {
  for (auto& sample : samples) {
    const double frames = static_cast<double>(sample.stamp.ns) * 1e-8 - seen;
    if (frames > -6 && frames < 0) spoil(sample);
  }
  return samples;
}

TEST_F(InTheDark, WheelsThatSlippedWhenItBeganAreHeard) {
  constexpr double kSlip_mps = 3;
  drive(spoiledInto(drive_.samples, kSeen, [](auto& sample) { sample.speed_mps += kSlip_mps; }));
  ASSERT_FALSE(odometry_.vehicleSensors()->believed);
  const Vector6d error = (drive_.motion(kSeen - 1, kSeen + kDark - 1).inverse() * steppedTo(kDark)).log();
  EXPECT_LT(error.head<3>().norm(), 2) << "of 30 m: they no longer slip";
  double variance_m2 = 0;
  for (const Odometry& step : steps_) variance_m2 += step.covariance.topLeftCorner<3, 3>().trace();
  EXPECT_NEAR(std::sqrt(variance_m2), 3 * kSlip_mps, 2) << "they might";
}

TEST_F(InTheDark, WhatElseWasWrongWhenItBeganIsNotHeard) {
  const auto kmh = [](auto& sample) { sample.speed_mps *= 3.6; };
  const auto turning = [](auto& sample) { sample.yaw_rate_radps += 0.3; };
  drive(spoiledInto(drive_.samples, kSeen, kmh));
  EXPECT_FALSE(steps_[20].told);
  steps_.clear(), odometry_ = {{}, test::kRig};
  drive(spoiledInto(drive_.samples, kSeen, turning));
  EXPECT_FALSE(steps_[20].told);
}

/// The clock that stamps samples is set back by two seconds in frame 20, or that of the camera alone.
class AfterAClockWasSetBack : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(OfBothAndOfTheCamera, AfterAClockWasSetBack, testing::Bool());

TEST_P(AfterAClockWasSetBack, SamplesBelongToTheirFrames) {
  constexpr std::int64_t kBack_ns = 2'000'000'000;
  constexpr int kFrames = 40, kSet = 20;
  const SimulatedVehicle drive(3, kFrames, {});
  auto log = std::make_shared<VehicleMotionLog>();
  VehicleOdometry odometry;
  std::size_t next = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Timestamp now = SimulatedVehicle::stampOf(frame);
    for (; next < drive.samples.size() && drive.samples[next].stamp <= now; ++next) {
      VehicleMotionSample sample = drive.samples[next];
      if (GetParam() && sample.stamp > SimulatedVehicle::stampOf(kSet)) sample.stamp.ns -= kBack_ns;
      log->add(sample);
    }
    odometry.hear({.ignored = {},
                   .vehicle_motion = log,
                   .vehicle_samples = next,
                   .clock_ahead_ns = frame > kSet + 4 ? kBack_ns : 0},
                  now);
    const auto step = frame > 0 ? odometry.motion(SimulatedVehicle::stampOf(frame - 1), now) : std::nullopt;
    if (frame > 0 && (frame <= kSet || frame > kSet + 5)) {
      ASSERT_TRUE(step) << frame;
      EXPECT_NEAR(step->T_then_now.translation().norm(), drive.motion(frame - 1, frame).translation().norm(), 0.1);
    }
  }
}

TEST_F(InTheDark, StepsAddUpToWhatIsKnownOfTheWhole) {
  drive(drive_.samples);
  const auto whole = odometry_.predict(drive_.stampOf(kSeen + kDark - 1));
  ASSERT_TRUE(whole.by_vehicle);
  SE3 T_seen_now;
  Matrix6d sum = Matrix6d::Zero();
  for (const Odometry& step : steps_) {
    ASSERT_TRUE(step.told);
    const Matrix6d A = step.told->T_previous_now.inverse().adjoint();
    sum = A * sum * A.transpose() + step.told->covariance;
    T_seen_now = T_seen_now * step.told->T_previous_now;
  }
  EXPECT_THAT(T_seen_now, test::IsNearPose(whole.T_seen_now, 1e-6));
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(std::sqrt(sum(i, i) / (*whole.by_vehicle)(i, i)), 1, 0.15) << i;
}

TEST_F(InTheDark, WhereSensorsFallSilentTheCameraGoesOnFromWhereTheyLed) {
  auto samples = drive_.samples;
  std::erase_if(samples, [](const auto& sample) { return sample.stamp > SimulatedVehicle::stampOf(kSeen + 10); });
  drive(samples);
  const double way_m = steppedTo(10).translation().norm();
  EXPECT_NEAR(way_m, drive_.motion(kSeen - 1, kSeen + 9).translation().norm(), 0.3);
  EXPECT_FALSE(steps_.back().told);
  EXPECT_LT((steppedTo(kDark).translation() - steppedTo(12).translation()).norm(), 1) << "and stands";
}

TEST_F(InTheDark, AfterAPauseOfTheSensorsTheCameraIsWhereTheyTell) {
  auto samples = drive_.samples;
  std::erase_if(samples, [](const auto& sample) {
    return sample.stamp > SimulatedVehicle::stampOf(kSeen + 10) && sample.stamp < SimulatedVehicle::stampOf(kSeen + 18);
  });
  drive(samples);
  EXPECT_FALSE(steps_[15].told);
  ASSERT_TRUE(steps_[20].told);
  EXPECT_LT((steppedTo(25).translation() - drive_.motion(kSeen - 1, kSeen + 24).translation()).norm(), 1.0);
  SE3 T_seen_now;
  for (int i = 0; i < 25; ++i) {
    const Odometry& step = steps_[static_cast<std::size_t>(i)];
    T_seen_now = T_seen_now * (step.told ? step.told->T_previous_now : step.T_previous_now);
  }
  EXPECT_THAT(T_seen_now, test::IsNearPose(steppedTo(25), 1e-6));
}

TEST_F(InTheDark, WithoutSensorsItIsTakenToStandAfterASecond) {
  drive({});
  EXPECT_FALSE(steps_.front().told);
  EXPECT_LT(steppedTo(kDark).translation().norm(), 20);
}

TEST(CameraOdometryWithSensors, ACarThatStandsIsSeenToStand) {
  std::vector<VehicleMotionSample> samples;
  for (int i = 0; i <= 200; ++i) samples.push_back({.stamp = {i * 50'000'000LL}});
  Inputs inputs(samples);
  CameraOdometry odometry({}, test::kRig);
  odometry.hear(inputs.upTo({10'000'000'000LL}), {10'000'000'000LL});
  odometry.add({0}, {.T_seen_now = SE3{}, .inliers = {}});
  test::Noise noise(5);
  for (int number = 1; number < 80; ++number) {
    std::vector<std::optional<KnownPoint>> known;
    std::vector<std::optional<StereoObservation>> observed;
    while (known.size() < 150) {
      const Eigen::Vector3d p = test::streetPoint(noise, 6, 40);
      const auto seen = test::lookTwice(p, p, noise);
      if (!seen) continue;
      known.push_back(KnownPoint{seen->p_ref, seen->covariance_ref, test::kRig.project(p)->z(), PointLabel::kUnknown});
      observed.emplace_back(StereoObservation{seen->uvd_px.cast<float>(), seen->sigma_px.cast<float>()});
    }
    StereoFrame frame;
    frame.head = {.frame = {number}, .stamp = {number * 100'000'000LL}};
    const CameraMotion motion = odometry.measure(frame, known, observed, odometry.predict(frame.head.stamp));
    EXPECT_EQ(motion.status, FrameStatus::kGood) << number;
    odometry.add(frame.head.stamp, motion);
  }
  EXPECT_TRUE(odometry.vehicleSensors()->believed);
}

TEST(CameraOdometryWithSensors, WhatIsNotLinkedByImagesStaysInTheSegment) {
  const SimulatedVehicle drive(4, 12, {});
  Inputs inputs(drive.samples);
  CameraOdometry odometry({}, test::kRig);
  odometry.hear(inputs.upTo(drive.stampOf(11)), drive.stampOf(11));
  odometry.add(drive.stampOf(0), {.T_seen_now = SE3{}, .inliers = {}});
  const auto predicted = odometry.predict(drive.stampOf(10));
  StereoFrame frame;
  frame.head.stamp = drive.stampOf(10);
  const CameraMotion unlinked = odometry.measure(frame, {}, {}, predicted);
  EXPECT_EQ(unlinked.cause, FrameCause::kUnlinked);
  const Odometry step = odometry.add(drive.stampOf(10), unlinked);
  ASSERT_TRUE(step.told);
  EXPECT_LT((step.T_previous_now.translation() - drive.motion(0, 10).translation()).norm(), 1.0);
  odometry.add(drive.stampOf(11), {.T_seen_now = drive.motion(10, 11), .inliers = {}});
  EXPECT_EQ(odometry.segment(), 0);
}

TEST(CameraOdometryWithSensors, AStartInTheDarkIsDrivenAsToldUntilSomethingIsSeen) {
  const SimulatedVehicle drive(4, 12, {});
  Inputs inputs(drive.samples);
  CameraOdometry odometry({}, test::kRig);
  odometry.hear(inputs.upTo(drive.stampOf(12)), drive.stampOf(12));
  SE3 T_start_now;
  for (int frame = 0; frame < 10; ++frame)
    T_start_now = T_start_now * odometry.passOver(drive.stampOf(frame)).T_previous_now;
  T_start_now = T_start_now * odometry.add(drive.stampOf(10), {.T_seen_now = SE3{}, .inliers = {}}).T_previous_now;
  EXPECT_LT((T_start_now.translation() - drive.motion(0, 10).translation()).norm(), 1.0);
}

}  // namespace
}  // namespace motorcade
