#include "frontend/motion/vehicle_samples.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

VehicleMotionSample at(double time_s, double speed_mps, double yaw_rate_radps = 0) {
  return {.stamp = {std::llround(1e9 * time_s)}, .speed_mps = speed_mps, .yaw_rate_radps = yaw_rate_radps};
}
Timestamp stamp(double time_s) { return {std::llround(1e9 * time_s)}; }

double wayOver(const VehicleSamples& samples, double from_s, double to_s) {
  const auto pieces = samples.between(stamp(from_s), stamp(to_s));
  if (!pieces) return std::numeric_limits<double>::quiet_NaN();
  double way_m = 0, time_s = 0;
  for (const auto& piece : *pieces) way_m += piece.speed_mps * piece.dt_s, time_s += piece.dt_s;
  EXPECT_NEAR(time_s, to_s - from_s, 1e-9);
  return way_m;
}

TEST(VehicleSamples, ASpeedThatGrowsIsIntegratedExactlyHoweverTheSpanIsCut) {
  VehicleSamples samples;
  for (int i = 0; i <= 20; ++i) samples.add(at(0.05 * i, 2 + 3 * 0.05 * i));
  EXPECT_NEAR(wayOver(samples, 0.1, 0.9), 2 * 0.8 + 1.5 * (0.81 - 0.01), 1e-9);
  EXPECT_NEAR(wayOver(samples, 0.1, 0.333) + wayOver(samples, 0.333, 0.9), wayOver(samples, 0.1, 0.9), 1e-9);
}

TEST(VehicleSamples, TheOrderInWhichTheyComeDoesNotMatter) {
  VehicleSamples in_order, mixed;
  for (int i = 0; i <= 10; ++i) in_order.add(at(0.1 * i, 5 + i % 3));
  for (const int i : {3, 0, 10, 9, 1, 2, 8, 4, 7, 5, 6}) mixed.add(at(0.1 * i, 5 + i % 3));
  EXPECT_EQ(wayOver(in_order, 0, 1), wayOver(mixed, 0, 1));
}

TEST(VehicleSamples, ASecondSampleOfAMomentAndWhatIsNoNumberAreLeftOut) {
  VehicleSamples samples;
  samples.add(at(0, 5));
  samples.add(at(0.1, 5));
  samples.add(at(0.1, 7));
  samples.add(at(0.05, std::numeric_limits<double>::quiet_NaN()));
  samples.add(at(0.06, 5, std::numeric_limits<double>::infinity()));
  EXPECT_NEAR(wayOver(samples, 0, 0.1), 0.5, 1e-9);
}

TEST(VehicleSamples, ValuesAreHeldForAQuarterOfASecondAndThenNothingIsKnown) {
  VehicleSamples samples;
  samples.add(at(1, 4));
  samples.add(at(1.1, 5));
  EXPECT_NEAR(wayOver(samples, 0.9, 1.0), 0.4, 1e-9);
  EXPECT_NEAR(wayOver(samples, 1.1, 1.3), 1.0, 1e-9);
  EXPECT_FALSE(samples.between(stamp(0.7), stamp(1.0)));
  EXPECT_FALSE(samples.between(stamp(1.1), stamp(1.4)));
  EXPECT_FALSE(VehicleSamples().between(stamp(0), stamp(1)));
}

TEST(VehicleSamples, AHoleOfMoreThanASecondIsNotBridgedAShorterOneIsLessSure) {
  VehicleSamples samples;
  for (const double time_s : {0.0, 0.1, 0.8, 0.9, 2.0}) samples.add(at(time_s, 6));
  const auto bridged = samples.between(stamp(0), stamp(0.9));
  ASSERT_TRUE(bridged);
  ASSERT_EQ(bridged->size(), 3U);
  EXPECT_EQ((*bridged)[0].unknown_s, 0);
  EXPECT_NEAR((*bridged)[1].unknown_s, 0.7, 1e-9);
  EXPECT_FALSE(samples.between(stamp(0), stamp(2)));
}

TEST(VehicleSamples, AWheelThatSpinsIsPassedOver) {
  VehicleSamples samples;
  for (int i = 0; i <= 60; ++i) samples.add(at(0.02 * i, i >= 4 && i < 34 ? 8.1 : 6));
  EXPECT_NEAR(wayOver(samples, 0, 1.2), 7.2, 1e-9);
  EXPECT_NEAR(wayOver(samples, 0, 0.5), 3.0, 1e-9) << "in the midst of it";
}

TEST(VehicleSamples, ALeapThatStaysIsBelievedAfterASecond) {
  VehicleSamples samples;
  for (int i = 0; i <= 100; ++i) samples.add(at(0.02 * i, i < 4 ? 6 : 16));
  EXPECT_NEAR(wayOver(samples, 1.2, 1.4), 3.2, 1e-9);
}

TEST(VehicleSamples, WhatIsForgottenLeavesTheNextSpanAsItWas) {
  VehicleSamples samples;
  for (int i = 0; i <= 20; ++i) samples.add(at(0.07 * i, 3 + i));
  const double before_m = wayOver(samples, 1.0, 1.3);
  samples.forgetBefore(stamp(1.0));
  EXPECT_EQ(wayOver(samples, 1.0, 1.3), before_m);
  EXPECT_FALSE(samples.between(stamp(0.2), stamp(0.5)));
}

}  // namespace
}  // namespace motorcade
