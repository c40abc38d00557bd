#include "apps/synth/output/vehicle_sensors.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace motorcade::synth {
namespace {

constexpr double kSample_s = 0.02, kDelay_s = 0.02;
constexpr double kScale = 0.02, kBias_radps = 0.3 * std::numbers::pi / 180;  // the most
constexpr double kSpeedNoise_mps = 0.03, kYawRateNoise_radps = 0.002;
constexpr double kSpin_s = 0.6, kSpin_mps = 2;
constexpr double kRearAxle_m = 1.3;  // behind the middle of the car

struct Motion {
  double speed_mps, yaw_rate_radps;
};

Motion motionAt(const Trajectory& car, double t_s) {
  constexpr double kStep_s = 0.005;
  const SE3 middle_rear(Eigen::Matrix3d::Identity(), {-kRearAxle_m, 0, 0});
  const SE3 before = car.T_map_body(t_s - kStep_s) * middle_rear, after = car.T_map_body(t_s + kStep_s) * middle_rear;
  const Vector6d step = (before.inverse() * after).log();
  return {step[0] / (2 * kStep_s), step[5] / (2 * kStep_s)};
}

}  // namespace

std::vector<VehicleMotionSample> sensedMotion(const Scene& scene, int frames) {
  constexpr std::uint64_t kOwnStream = 0x5E45;  // of random numbers: pictures use others of the same seed
  std::mt19937_64 random(kOwnStream + scene.seed);
  std::uniform_real_distribution<double> upTo(-1, 1), share(0, 1);
  std::normal_distribution<double> noise;
  const double end_s = scene.frame_s * (frames - 1);
  const double scale = 1 + kScale * upTo(random), bias_radps = kBias_radps * upTo(random);
  const double spin_s = (0.3 + 0.6 * share(random)) * end_s;
  std::vector<VehicleMotionSample> samples;
  for (int k = 0; k * kSample_s <= end_s; ++k) {
    const double t_s = k * kSample_s;
    const Motion true_motion = motionAt(scene.ego.trajectory, t_s);
    const bool spins = t_s >= spin_s && t_s < spin_s + kSpin_s && true_motion.speed_mps > 1;
    samples.push_back(
        {.stamp = {std::llround(1e9 * (t_s + kDelay_s))},
         .speed_mps = scale * true_motion.speed_mps + (spins ? kSpin_mps : 0) + kSpeedNoise_mps * noise(random),
         .yaw_rate_radps = true_motion.yaw_rate_radps + bias_radps + kYawRateNoise_radps * noise(random)});
  }
  return samples;
}

}  // namespace motorcade::synth
