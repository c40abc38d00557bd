#include "apps/interface/vehicle_motion_input.hpp"

#include <cmath>

namespace motorcade {

const char* problemOf(const VehicleMotion& motion) {
  constexpr double kMaxSpeed_mps = 150, kMaxYawRate_radps = 10;  // of anything with wheels
  if (motion.stamp_ns < -kFarthestStamp_ns || motion.stamp_ns > kFarthestStamp_ns) return "its stamp is beyond 2^62 ns";
  if (!(std::abs(motion.speed_mps) <= kMaxSpeed_mps)) return "its speed is no number up to 150 m/s";
  if (!(std::abs(motion.yaw_rate_radps) <= kMaxYawRate_radps)) return "its yaw rate is no number up to 10 rad/s";
  const bool known = motion.speed_sigma_mps >= 0 && motion.yaw_rate_sigma_radps >= 0 &&
                     std::isfinite(motion.speed_sigma_mps) && std::isfinite(motion.yaw_rate_sigma_radps);
  return known ? nullptr : "a standard deviation of it is negative, or no number; 0 leaves it open";
}

VehicleMotionSample sampleOf(const VehicleMotion& motion) {
  return {.stamp = {motion.stamp_ns},
          .speed_mps = motion.speed_mps,
          .yaw_rate_radps = motion.yaw_rate_radps,
          .speed_sigma_mps = motion.speed_sigma_mps,
          .yaw_rate_sigma_radps = motion.yaw_rate_sigma_radps};
}

}  // namespace motorcade
