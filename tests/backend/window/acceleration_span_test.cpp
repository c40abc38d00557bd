#include "backend/window/acceleration_span.hpp"

#include <array>
#include <cmath>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

/// An object with a twist in frames that are so far apart, from frame 10 on.
ObjectTrack trackOf(int frames, double dt_s) {
  ObjectTrack track;
  for (int i = 0; i < frames; ++i) {
    ObjectRecord& record = track.records[FrameId{10 + i}];
    record.stamp = {static_cast<std::int64_t>(1e9 * dt_s * i)};
    record.twist = VariableId{i};
  }
  return track;
}

void expectSpan(const ObjectTrack& track, int frame, std::array<double, 2> before_and_after_s) {
  constexpr double kRounding_s = 1e-9;
  const auto span = accelerationSpan(track, FrameId{10 + frame}, 0.4);
  ASSERT_TRUE(span) << frame;
  EXPECT_NEAR(span->before_s, before_and_after_s[0], kRounding_s) << frame;
  EXPECT_NEAR(span->after_s, before_and_after_s[1], kRounding_s) << frame;
  const Timestamp stamp = track.records.at(FrameId{10 + frame}).stamp;
  EXPECT_NEAR(secondsBetween(span->from->stamp, stamp), span->before_s, kRounding_s);
  EXPECT_NEAR(secondsBetween(stamp, span->to->stamp), span->after_s, kRounding_s);
}

TEST(AccelerationSpan, ReachesToBothSidesAsFarAsTheObjectsFramesGo) {
  const ObjectTrack track = trackOf(12, 0.1);
  expectSpan(track, 5, {0.4, 0.4});
  expectSpan(track, 0, {0, 0.4});
  expectSpan(track, 2, {0.2, 0.4});
  expectSpan(track, 11, {0.4, 0});
}

TEST(AccelerationSpan, TellsWhetherAnythingComesBeforeAndAfter) {
  const ObjectTrack track = trackOf(12, 0.1);
  for (const auto& [frame, at_end] : {std::pair(4, true), std::pair(5, false), std::pair(6, false), std::pair(7, true)})
    EXPECT_EQ(accelerationSpan(track, FrameId{10 + frame}, 0.4)->at_end, at_end) << frame;
}

TEST(AccelerationSpan, IsInSecondsWhateverTheRate) {
  expectSpan(trackOf(60, 1.0 / 30), 30, {0.4, 0.4});
  expectSpan(trackOf(12, 0.15), 5, {0.3, 0.3});
}

TEST(AccelerationSpan, ReachesTheNeighborsWhereFramesAreRare) { expectSpan(trackOf(4, 0.5), 1, {0.5, 0.5}); }

TEST(AccelerationSpan, EndsWhereTheGraphHasNoTwist) {
  ObjectTrack track = trackOf(12, 0.1);
  track.records.at({13}).twist = {};
  expectSpan(track, 5, {0.1, 0.4});
  EXPECT_FALSE(accelerationSpan(track, {13}, 0.4));
  EXPECT_FALSE(accelerationSpan(track, {30}, 0.4)) << "a frame without the object";
  EXPECT_FALSE(accelerationSpan(trackOf(1, 0.1), {10}, 0.4)) << "the object's only frame";
}

/// Ten thousand walks, in steps of a hundredth of the span.
double simulatedVariance(double before_s, double after_s, double density) {
  constexpr int kWalks = 10'000, kSteps = 100;
  std::mt19937_64 engine(3);
  std::normal_distribution<double> gaussian;
  double squares = 0;
  for (int walk = 0; walk < kWalks; ++walk) {
    double sum = 0;  // integral of the derivative, which is 0 in the frame
    for (const double side_s : {before_s, after_s}) {
      const double step_s = side_s / kSteps;
      double derivative = 0;
      for (int step = 0; step < kSteps; ++step) {
        const double next = derivative + std::sqrt(density * step_s) * gaussian(engine);
        sum += step_s * (derivative + next) / 2;
        derivative = next;
      }
    }
    squares += std::pow(sum / (before_s + after_s), 2);
  }
  return squares / kWalks;
}

TEST(AccelerationSpan, TheWalksVarianceIsThatOfWalksThatAreSimulated) {
  constexpr double kDensity = 0.7, kChance = 0.05;  // 3.5 standard deviations of a variance of ten thousand
  for (const auto& [before_s, after_s] : {std::array{0.4, 0.4}, std::array{0.5, 0.0}, std::array{0.1, 0.6}}) {
    const AccelerationSpan span{
        .from = nullptr, .to = nullptr, .before_s = before_s, .after_s = after_s, .at_end = false};
    const double expected = simulatedVariance(before_s, after_s, kDensity);
    EXPECT_NEAR(span.walkVariance(kDensity), expected, kChance * expected) << before_s << " " << after_s;
  }
  const AccelerationSpan centered{.from = nullptr, .to = nullptr, .before_s = 0.4, .after_s = 0.4, .at_end = false};
  EXPECT_DOUBLE_EQ(centered.walkVariance(3), 3 * 0.8 / 12);
  const AccelerationSpan one_sided{.from = nullptr, .to = nullptr, .before_s = 0.8, .after_s = 0, .at_end = true};
  EXPECT_DOUBLE_EQ(one_sided.walkVariance(3), 3 * 0.8 / 3);
}

}  // namespace
}  // namespace motorcade
