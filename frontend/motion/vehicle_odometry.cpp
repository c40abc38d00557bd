#include "frontend/motion/vehicle_odometry.hpp"

#include <cmath>
#include <span>

namespace motorcade {
namespace {

// Sensors that contradict the camera from the start are left out after three frames. They are heard again after 8 to 19
// frames in which they agreed.
constexpr double kAgreementRate = 0.1, kLeastAgreement = 0.7, kRegainedAgreement = 0.85;
constexpr double kStrange_sigmas = 4;
// Wheels that slip: the yaw rate is right, and the speed not wrong by more than half of what is seen. Sensors that have
// agreed in twenty frames, as many as it takes to be heard again, are heard where nothing is seen, up to ten frames on.
constexpr double kMostSlip = 0.5, kLatelyAgreed = 0.35;
constexpr int kProven = 20;
/// Samples are late by less: a larger distance from their frame shows that a clock was set.
constexpr double kClearlyApart_s = 0.25;

double secondsApart(Timestamp sample, std::int64_t ahead_ns, Timestamp frame) {
  return 1e-9 *
         std::abs(static_cast<double>(sample.ns) + static_cast<double>(ahead_ns) - static_cast<double>(frame.ns));
}

/// Motion of a camera that looks ahead, or the mean over pieces.
VehicleSensors::Motion motionOf(const SE3& T_then_now, double dt_s) {
  return {T_then_now.translation().z() / dt_s, -T_then_now.log()[4] / dt_s};
}
VehicleSensors::Motion motionOf(std::span<const VehicleSamples::Piece> pieces, double dt_s) {
  VehicleSensors::Motion mean;
  for (const auto& piece : pieces) {
    mean.speed_mps += piece.speed_mps * piece.dt_s / dt_s;
    mean.yaw_rate_radps += piece.yaw_rate_radps * piece.dt_s / dt_s;
  }
  return mean;
}

}  // namespace

void VehicleOdometry::hear(const FrameInputs& inputs, Timestamp frame) {
  if (!inputs.vehicle_motion || inputs.vehicle_samples <= heard_) return;
  for (VehicleMotionSample sample : inputs.vehicle_motion->read(heard_, inputs.vehicle_samples)) {
    const double apart_s = secondsApart(sample.stamp, ahead_ns_, frame);
    if (apart_s > kClearlyApart_s && secondsApart(sample.stamp, inputs.clock_ahead_ns, frame) < apart_s)
      ahead_ns_ = inputs.clock_ahead_ns;
    sample.stamp.ns += ahead_ns_;
    samples_.add(sample);
  }
  heard_ = inputs.vehicle_samples;
}

std::optional<UncertainMotion> VehicleOdometry::motion(Timestamp from, Timestamp to) const {
  if (!believed_ || heard_ == 0 || from >= to) return std::nullopt;
  const auto pieces = samples_.between(from, to);
  if (!pieces) return std::nullopt;
  return calibration_.motionOver(*pieces);
}

std::optional<UncertainMotion> VehicleOdometry::motionUnseen(Timestamp from, Timestamp to) const {
  if (believed_ || !slipsLately() || from >= to) return motion(from, to);
  const auto pieces = samples_.between(from, to);
  if (!pieces) return std::nullopt;
  return calibration_.motionOver(*pieces, *slip_mps_);
}

bool VehicleOdometry::slipsLately() const { return slip_mps_ && agreed_ >= kProven && agreement_ > kLatelyAgreed; }

void VehicleOdometry::compare(Timestamp from, Timestamp to, const UncertainMotion& seen) {
  if (heard_ == 0 || from >= to) return;
  const auto pieces = samples_.between(from, to);
  if (!pieces) return;
  const auto [speed_mps, speed_sigmas, yaw_rate_sigmas] = calibration_.compare(*pieces, seen);
  const bool turns_alike = yaw_rate_sigmas < kStrange_sigmas, agrees = speed_sigmas < kStrange_sigmas && turns_alike;
  told_ = motionOf(*pieces, secondsBetween(from, to));
  seen_ = motionOf(seen.T_then_now, secondsBetween(from, to));
  slip_mps_.reset();
  if (turns_alike && std::abs(speed_mps) < kMostSlip * std::abs(seen_.speed_mps)) slip_mps_ = std::abs(speed_mps);
  if (agrees) calibration_.learn(*pieces, seen);
  judge(agrees);
}

void VehicleOdometry::judge(bool agrees) {
  agreement_ += kAgreementRate * ((agrees ? 1 : 0) - agreement_);
  if (agrees) disputed_ = 0, ++agreed_;
  believed_ = agreement_ > (believed_ ? kLeastAgreement : kRegainedAgreement);
}

/// Counts frames in dispute, of which many end the belief: vehicles do not fill the view for ever, and a sensor may
/// stick.
void VehicleOdometry::dispute() {
  constexpr int kMostDisputed = 50;
  if (++disputed_ < kMostDisputed) return;
  agreement_ = 0;
  believed_ = false;
}

std::optional<VehicleSensors> VehicleOdometry::sensors() const {
  if (heard_ == 0) return std::nullopt;
  return VehicleSensors{.believed = believed_,
                        .speed_scale = calibration_.scale(),
                        .yaw_rate_bias_radps = calibration_.bias_radps(),
                        .told = told_,
                        .seen = seen_};
}

}  // namespace motorcade
