#include "frontend/motion/vehicle_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace motorcade {
namespace {

constexpr std::size_t kMostSamples = 20'000;  // 20 s at 1 kHz
constexpr double kHeld_s = 0.25;              // beyond the first and the last sample
constexpr double kBridged_s = 1.0;            // between two samples
constexpr double kUsual_s = 0.12;             // between two samples: sensors with ten a second are slow ones
/// Limits of believable changes of speed: tires hold no more than 1.2 g, and the rest is steps and noise of the sensor.
constexpr double kMaxAcceleration_mps2 = 12, kStep_mps = 0.5;
constexpr double kMostPassedOver_s = 0.9;  // wheels spin or lock no longer: it was the sensor that leapt
constexpr double kBackShare = 0.5;         // of a leap: by so much at least it goes back

bool isFinite(const VehicleMotionSample& sample) {
  return std::isfinite(sample.speed_mps) && std::isfinite(sample.yaw_rate_radps);
}

/// Interpolates values between two samples, or takes those of the nearer one beside them.
VehicleMotionSample at(const VehicleMotionSample& before, const VehicleMotionSample& after, Timestamp stamp) {
  const double gap_s = secondsBetween(before.stamp, after.stamp);
  const double share = gap_s > 0 ? std::clamp(secondsBetween(before.stamp, stamp) / gap_s, 0.0, 1.0) : 0.0;
  return {.stamp = stamp,
          .speed_mps = std::lerp(before.speed_mps, after.speed_mps, share),
          .yaw_rate_radps = std::lerp(before.yaw_rate_radps, after.yaw_rate_radps, share),
          .speed_sigma_mps = std::max(before.speed_sigma_mps, after.speed_sigma_mps),
          .yaw_rate_sigma_radps = std::max(before.yaw_rate_sigma_radps, after.yaw_rate_sigma_radps)};
}

/// Change of speed where no vehicle could make it, else 0.
double leapBetween(const VehicleMotionSample& before, const VehicleMotionSample& now) {
  const double change_mps = now.speed_mps - before.speed_mps;
  const double possible_mps = kStep_mps + kMaxAcceleration_mps2 * secondsBetween(before.stamp, now.stamp);
  return std::abs(change_mps) > possible_mps ? change_mps : 0;
}

VehicleSamples::Piece pieceOf(const VehicleMotionSample& from, const VehicleMotionSample& to, double unknown_s) {
  return {.dt_s = secondsBetween(from.stamp, to.stamp),
          .speed_mps = (from.speed_mps + to.speed_mps) / 2,
          .yaw_rate_radps = (from.yaw_rate_radps + to.yaw_rate_radps) / 2,
          .speed_sigma_mps = std::max(from.speed_sigma_mps, to.speed_sigma_mps),
          .yaw_rate_sigma_radps = std::max(from.yaw_rate_sigma_radps, to.yaw_rate_sigma_radps),
          .unknown_s = unknown_s};
}

}  // namespace

void VehicleSamples::add(const VehicleMotionSample& sample) {
  const auto place = std::ranges::lower_bound(samples_, sample.stamp, {}, &VehicleMotionSample::stamp);
  if (!isFinite(sample) || (place != samples_.end() && place->stamp == sample.stamp)) return;
  samples_.insert(place, sample);
  if (samples_.size() > kMostSamples) samples_.erase(samples_.begin());
}

/// Forgets samples before a moment, but keeps one.
void VehicleSamples::forgetBefore(Timestamp stamp) {
  const auto first = std::ranges::upper_bound(samples_, stamp, {}, &VehicleMotionSample::stamp);
  if (first - samples_.begin() > 1) samples_.erase(samples_.begin(), std::prev(first));
}

/// Samples within the span, with one before and one after it where there are. After a leap samples are passed over, and
/// the speed before it is held, until one leaps back.
std::vector<VehicleMotionSample> VehicleSamples::believable(Timestamp from, Timestamp to) const {
  auto it = std::ranges::upper_bound(samples_, from, {}, &VehicleMotionSample::stamp);
  if (it != samples_.begin()) --it;
  std::vector<VehicleMotionSample> found;
  double leap_mps = 0;
  for (; it != samples_.end() && (found.empty() || found.back().stamp < to); ++it) {
    const double change_mps = found.empty() ? 0 : leapBetween(*std::prev(it), *it);
    const bool goes_back = change_mps * leap_mps < 0 && std::abs(change_mps) > kBackShare * std::abs(leap_mps);
    if (leap_mps == 0)
      leap_mps = change_mps;
    else if (goes_back || secondsBetween(found.back().stamp, it->stamp) > kMostPassedOver_s)
      leap_mps = 0;
    if (leap_mps == 0) found.push_back(*it);
  }
  if (leap_mps != 0) {
    found.push_back(found.back());
    found.back().stamp = samples_.back().stamp;
  }
  return found;
}

std::optional<std::vector<VehicleSamples::Piece>> VehicleSamples::between(Timestamp from, Timestamp to) const {
  const std::vector<VehicleMotionSample> samples = believable(from, to);
  if (samples.empty() || secondsBetween(from, samples.front().stamp) > kHeld_s ||
      secondsBetween(samples.back().stamp, to) > kHeld_s)
    return std::nullopt;
  std::vector<Piece> pieces;
  VehicleMotionSample last = at(samples.front(), samples.size() > 1 ? samples[1] : samples.front(), from);
  for (std::size_t i = 0; i <= samples.size() && last.stamp < to; ++i) {
    const bool held = i == samples.size();
    const Timestamp end = held ? to : std::min(samples[i].stamp, to);
    if (end <= last.stamp) continue;
    const VehicleMotionSample& before = samples[i == 0 ? 0 : i - 1];
    const VehicleMotionSample& after = held ? before : samples[i];
    const double gap_s = secondsBetween(before.stamp, held ? to : after.stamp);
    if (gap_s > kBridged_s) return std::nullopt;
    const VehicleMotionSample next = at(before, after, end);
    pieces.push_back(pieceOf(last, next, gap_s > kUsual_s ? gap_s : 0));
    last = next;
  }
  return pieces;
}

}  // namespace motorcade
