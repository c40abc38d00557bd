#include "frontend/motion/vehicle_odometry.hpp"

#include <cmath>

namespace motorcade {
namespace {

// Sensors that contradict the camera from the start are left out after three frames, and are heard again after some
// twenty in which they agreed.
constexpr double kAgreementRate = 0.1, kLeastAgreement = 0.7, kRegainedAgreement = 0.85;
constexpr double kStrange_sigmas = 4;
constexpr double kLeastSpeed_mps = 1;  // at which speeds have a ratio

}  // namespace

void VehicleOdometry::hear(const FrameInputs& inputs) {
  if (!inputs.vehicle_motion || inputs.vehicle_samples <= heard_) return;
  for (const VehicleMotion& sample : inputs.vehicle_motion->read(heard_, inputs.vehicle_samples)) samples_.add(sample);
  heard_ = inputs.vehicle_samples;
}

std::optional<UncertainMotion> VehicleOdometry::motion(Timestamp from, Timestamp to) const {
  if (!believed_ || heard_ == 0 || from >= to) return std::nullopt;
  const auto pieces = samples_.between(from, to);
  if (!pieces) return std::nullopt;
  return calibration_.motionOver(*pieces);
}

void VehicleOdometry::compare(Timestamp from, Timestamp to, const UncertainMotion& seen) {
  if (heard_ == 0 || from >= to) return;
  const auto pieces = samples_.between(from, to);
  if (!pieces) return;
  const auto [speed_sigmas, yaw_rate_sigmas] = calibration_.compare(*pieces, seen);
  const bool agrees = speed_sigmas < kStrange_sigmas && yaw_rate_sigmas < kStrange_sigmas;
  followRatio(*pieces, seen.T_then_now);
  if (agrees) calibration_.learn(*pieces, seen);
  judge(agrees);
}

void VehicleOdometry::judge(bool agrees) {
  agreement_ += kAgreementRate * ((agrees ? 1 : 0) - agreement_);
  believed_ = agreement_ > (believed_ ? kLeastAgreement : kRegainedAgreement);
}

void VehicleOdometry::followRatio(std::span<const VehicleSamples::Piece> pieces, const SE3& T_then_now) {
  double way_m = 0, time_s = 0;
  for (const auto& piece : pieces) way_m += piece.speed_mps * piece.dt_s, time_s += piece.dt_s;
  if (std::abs(way_m) < kLeastSpeed_mps * time_s) return;
  const double ratio = T_then_now.translation().z() / way_m;
  speed_ratio_ += kAgreementRate * (ratio - speed_ratio_);
}

std::optional<VehicleSensors> VehicleOdometry::sensors() const {
  if (heard_ == 0) return std::nullopt;
  return VehicleSensors{.believed = believed_,
                        .speed_scale = calibration_.scale(),
                        .yaw_rate_bias_radps = calibration_.bias_radps(),
                        .speed_ratio = speed_ratio_};
}

}  // namespace motorcade
