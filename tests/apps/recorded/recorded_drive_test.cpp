#include "apps/recorded/recorded_drive.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>

#include "io/layouts/open_sequence.hpp"
#include "tests/support/data_folder.hpp"

namespace motorcade {
namespace {

constexpr double kInterval_s = 0.1;

/// A track of `frames` places, ten a second, by the time since its first.
template <class PlaceAt>
std::vector<StampedPlace> trackOf(int frames, const PlaceAt& place_at) {
  std::vector<StampedPlace> track;
  for (int i = 0; i < frames; ++i) track.push_back({Timestamp{i * 100'000'000LL}, place_at(i * kInterval_s)});
  return track;
}

TEST(LabelMotion, AClosedLapTravelsThoughItEndsWhereItBegan) {
  constexpr double kRadius_m = 20, kLap_s = 30;
  const auto lap = trackOf(301, [&](double t_s) -> Eigen::Vector3d {
    const double angle_rad = 2 * std::numbers::pi * t_s / kLap_s;
    return {kRadius_m * std::cos(angle_rad), 1.6, kRadius_m * std::sin(angle_rad)};
  });
  ASSERT_LT((lap.back().p_world - lap.front().p_world).norm(), 0.1);
  EXPECT_TRUE(travels(lap));
}

TEST(LabelMotion, WhatWaitsLongBeforeItDrivesTravels) {
  constexpr double kWait_s = 60;
  const auto waiting = [&](double acceleration_mps2) {
    return trackOf(630, [&](double t_s) -> Eigen::Vector3d {
      const double driven_s = std::max(0.0, t_s - kWait_s);
      return {0, 1.6, 20 + acceleration_mps2 / 2 * driven_s * driven_s};
    });
  };
  EXPECT_TRUE(travels(waiting(2))) << "8 m in the last three of 63 seconds";
  EXPECT_FALSE(travels(waiting(0.1))) << "half a meter";
}

TEST(LabelMotion, ParkedCarsWhoseLabelsWanderAndJumpDoNotTravel) {
  std::mt19937 random(3);
  std::normal_distribution<double> jitter_m(0, 0.15);
  const auto parked = [&](double creep_mps, double jump_m) {
    return trackOf(100, [&](double t_s) -> Eigen::Vector3d {
      return {jitter_m(random), 1.6, 30 + creep_mps * t_s + (t_s > 5 ? jump_m : 0) + jitter_m(random)};
    });
  };
  EXPECT_FALSE(travels(parked(0, 0)));
  EXPECT_FALSE(travels(parked(0.4, 0))) << "four meters in ten seconds, as labels of far cars wander";
  EXPECT_FALSE(travels(parked(0, 2.5))) << "the truth of the camera jumped";
  EXPECT_TRUE(travels(parked(1.4, 0))) << "a pedestrian";
}

TEST(LabelMotion, ShortTracksOfFastObjectsTravel) {
  const auto two = trackOf(2, [](double t_s) -> Eigen::Vector3d { return {0, 0, 20 * t_s}; });
  EXPECT_TRUE(travels(two));
  EXPECT_FALSE(travels({two.front()}));
  EXPECT_FALSE(travels({}));
}

std::set<std::int64_t> travelingIn(const char* drive) {
  const Sequence sequence = openSequence(test::dataFolder() / drive);
  return travelingLabels(readObjectTruths(sequence, *readCameraTruth(sequence))->objects, sequence.stamps);
}

TEST(LabelMotion, OnRealDrivesTheParkedCarsStandAndTheOthersMove) {
  if (!std::filesystem::exists(test::dataFolder() / "kitti_tracking_0003"))
    GTEST_SKIP() << test::dataFolder() / "kitti_tracking_0003"
                 << " is not there";
  EXPECT_THAT(travelingIn("kitti_tracking_0003"), testing::ElementsAre(0, 1, 5));
  EXPECT_THAT(travelingIn("kitti_tracking_0001"), testing::ElementsAre(8));
  EXPECT_THAT(travelingIn("rendered_street"), testing::ElementsAre(0, 1, 2, 3));
}

}  // namespace
}  // namespace motorcade
