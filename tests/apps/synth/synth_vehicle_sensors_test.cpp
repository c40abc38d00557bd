#include <cstdint>

#include <gtest/gtest.h>

#include "apps/synth/output/ground_truth.hpp"
#include "apps/synth/scenes/scene_builder.hpp"

namespace motorcade::synth {
namespace {

TEST(SynthVehicleSensors, TellTheWayOfTheCarUpToTheirFaults) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const Scene scene = makeScene("urban", seed);
    const auto samples = sensedMotion(scene, 60);
    ASSERT_EQ(samples.size(), 296U);
    EXPECT_EQ(samples.front().stamp.ns, 20'000'000) << "late";
    double way_m = 0, turn_rad = 0;
    for (const auto& sample : samples) way_m += 0.02 * sample.speed_mps, turn_rad += 0.02 * sample.yaw_rate_radps;
    const SE3 T_first_last = scene.ego.T_map_cam(0).inverse() * scene.ego.T_map_cam(5.9);
    const double true_way_m = scene.ego.trajectory.distance_m(5.9);
    EXPECT_NEAR(way_m, true_way_m, 0.02 * true_way_m + 1.5) << "2 % of scale and 0.6 s of spinning wheels";
    EXPECT_NEAR(turn_rad, -T_first_last.log()[4], 0.04) << "0.3 deg/s";
  }
  EXPECT_NE(sensedMotion(makeScene("urban", 1), 9)[5].speed_mps, sensedMotion(makeScene("urban", 2), 9)[5].speed_mps);
}

}  // namespace
}  // namespace motorcade::synth
