#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/se3.hpp"
#include "core/vehicle_motion.hpp"

namespace motorcade::test {

/// A drive over a road with curves and slopes, with the camera's true poses every tenth of a second. The vehicle's
/// sensors tell of it with a wrong scale, a bias, noise and a delay.
struct SimulatedVehicle {
  struct Faults {
    double scale = 1.02;                     // told over true speed
    double bias_radps = 0.3 * 0.0174532925;  // told less true
    double delay_s = 0.02;                   // by which stamps are late
    double speed_noise_mps = 0.05, yaw_rate_noise_radps = 0.003;
  };
  static constexpr double kFrame_s = 0.1;
  static constexpr double kLever_m = 1.7, kTravelYaw_rad = 0.015, kTravelPitch_rad = -0.02;

  std::vector<SE3> T_world_cam;  // one per frame
  std::vector<VehicleMotionSample> samples;

  static Timestamp stampOf(int frame) { return {static_cast<std::int64_t>(frame) * 100'000'000}; }

  SimulatedVehicle(std::uint64_t seed, int frames, const Faults& faults) : SimulatedVehicle(seed, frames, faults, 1) {}

  /// A road with hills `roughness` times as rough as real ones.
  SimulatedVehicle(std::uint64_t seed, int frames, const Faults& faults, double roughness) {
    constexpr int kSteps = 20;  // per frame
    constexpr double kStep_s = kFrame_s / kSteps;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const SE3 T_vehicle_cam = mounting();
    const double phase = 10 * normal(random);
    SE3 T_world_vehicle;
    double slope_rate = 0;
    for (int step = 0; step <= frames * kSteps; ++step) {
      const double t_s = step * kStep_s;
      const double speed_mps = 10 + 4 * std::sin(0.25 * t_s + phase) + 2 * std::sin(0.9 * t_s);
      const double yaw_rate_radps = 0.1 * std::sin(0.35 * t_s + 2 * phase);
      if (step % kSteps == 0) {
        const Eigen::Vector3d bump(0.002 * normal(random), 0.002 * normal(random), 0);
        T_world_cam.push_back(T_world_vehicle * SE3(expSO3(bump), {0, 0, 0}) * T_vehicle_cam);
        slope_rate = roughness * 0.8e-3 * normal(random) * std::sqrt(speed_mps / kFrame_s);
      }
      if (step % 4 == 0)  // fifty a second
        samples.push_back(
            {.stamp = {static_cast<std::int64_t>(1e9 * (t_s + faults.delay_s))},
             .speed_mps = faults.scale * speed_mps + faults.speed_noise_mps * normal(random),
             .yaw_rate_radps = yaw_rate_radps + faults.bias_radps + faults.yaw_rate_noise_radps * normal(random)});
      Vector6d twist;
      twist << speed_mps, 0, 0, 0, slope_rate, yaw_rate_radps;
      T_world_vehicle = (T_world_vehicle * SE3::exp(kStep_s * twist)).normalized();
    }
  }

  static SE3 mounting() {
    Eigen::Matrix3d R_vehicle_ahead;
    R_vehicle_ahead << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    return {expSO3({0, kTravelPitch_rad, kTravelYaw_rad}) * R_vehicle_ahead, {kLever_m, 0, 0}};
  }
  SE3 motion(int from, int to) const { return T_world_cam[from].inverse() * T_world_cam[to]; }
};

}  // namespace motorcade::test
