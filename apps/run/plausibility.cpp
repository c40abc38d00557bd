#include "apps/run/plausibility.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace motorcade {
namespace {

constexpr double kMostPeriod_s = 2, kLeastPeriod_s = 5e-4;
constexpr double kMostSpeed_mps = 75;  // 270 km/h
constexpr int kPersistent_frames = 5;

std::string text(const char* format, double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

}  // namespace

bool Plausibility::Persistent::observe(bool holds) {
  frames_ = holds ? frames_ + 1 : 0;
  if (told_ || frames_ < kPersistent_frames) return false;
  return told_ = true;
}

std::optional<std::string> Plausibility::observe(const FrameEstimate& online) {
  const auto before = std::exchange(before_, Seen{online.head.stamp, online.head.status, online.T_world_cam});
  if (!before) return std::nullopt;
  const double period_s = secondsBetween(before->stamp, online.head.stamp);
  if (far_apart_.observe(period_s > kMostPeriod_s))
    return "pairs are " + text("%.4g", period_s) +
           " s apart: nothing that moves can be followed; times must be in seconds";
  if (close_together_.observe(period_s < kLeastPeriod_s))
    return "pairs are " + text("%.4g", period_s) + " s apart: speeds cannot be right; times must be in seconds";
  const double speed_mps =
      (before->T_world_cam.inverse() * online.T_world_cam).translation().norm() / std::max(period_s, 1e-9);
  const bool measured = before->status == FrameStatus::kGood && online.head.status == FrameStatus::kGood;
  if (too_fast_.observe(measured && speed_mps > kMostSpeed_mps))
    return "the camera would move at " + text("%.4g", speed_mps) +
           " m/s: are the times (or --fps) in seconds and the calibration in meters?";
  return std::nullopt;
}

}  // namespace motorcade
