#include "apps/run/plausibility.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace motorcade {
namespace {

constexpr double kLeastBaseline_m = 0.03, kMostBaseline_m = 3;
constexpr double kLeastFocal = 0.2, kMostFocal = 10;  // focal length over image width: 136 and 6 degrees wide
constexpr double kMostPeriod_s = 2, kLeastPeriod_s = 5e-4;
constexpr double kMostSpeed_mps = 75;  // 270 km/h
constexpr int kPersistent_frames = 5;

std::string text(const char* format, double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

/// Of the principal point, as a share of the image's size.
bool isFarFromMiddle(double share) { return share < 0.3 || share > 0.7; }

}  // namespace

std::vector<std::string> doubtsAbout(const StereoCamera& camera) {
  std::vector<std::string> doubts;
  if (camera.baseline_m < kLeastBaseline_m || camera.baseline_m > kMostBaseline_m)
    doubts.push_back("the calibration tells a baseline of " + text("%.4g", camera.baseline_m) +
                     " m; its translations must be in meters (P1: -fx times the baseline)");
  const double focal = camera.fx_px / camera.width_px;
  if (focal < kLeastFocal || focal > kMostFocal)
    doubts.push_back("the calibration tells a focal length of " + text("%.4g", camera.fx_px) + " px for images " +
                     std::to_string(camera.width_px) + " px wide; is it that of another image size?");
  if (camera.cx_px <= 0 || camera.cx_px >= camera.width_px || camera.cy_px <= 0 || camera.cy_px >= camera.height_px)
    doubts.push_back("the calibration's principal point (" + text("%.5g", camera.cx_px) + ", " +
                     text("%.5g", camera.cy_px) + ") lies outside the image; is it that of another image size?");
  else if (isFarFromMiddle(camera.cx_px / camera.width_px) || isFarFromMiddle(camera.cy_px / camera.height_px))
    doubts.push_back("the calibration's principal point (" + text("%.5g", camera.cx_px) + ", " +
                     text("%.5g", camera.cy_px) + ") lies far from the middle of images of " +
                     std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px) +
                     " px; is it that of another image size?");
  return doubts;
}

bool Plausibility::Persistent::observe(bool holds) {
  frames_ = holds ? frames_ + 1 : 0;
  if (told_ || frames_ < kPersistent_frames) return false;
  return told_ = true;
}

std::optional<std::string> Plausibility::observe(const FrameEstimate& online) {
  const auto before = std::exchange(before_, Seen{online.stamp, online.status, online.T_world_cam});
  if (!before) return std::nullopt;
  const double period_s = secondsBetween(before->stamp, online.stamp);
  if (far_apart_.observe(period_s > kMostPeriod_s))
    return "pairs are " + text("%.4g", period_s) +
           " s apart: nothing that moves can be followed; times must be in seconds";
  if (close_together_.observe(period_s < kLeastPeriod_s))
    return "pairs are " + text("%.4g", period_s) + " s apart: speeds cannot be right; times must be in seconds";
  const double speed_mps =
      (before->T_world_cam.inverse() * online.T_world_cam).translation().norm() / std::max(period_s, 1e-9);
  const bool measured = before->status == FrameStatus::kGood && online.status == FrameStatus::kGood;
  if (too_fast_.observe(measured && speed_mps > kMostSpeed_mps))
    return "the camera would move at " + text("%.4g", speed_mps) +
           " m/s: are the times (or --fps) in seconds and the calibration in meters?";
  return std::nullopt;
}

}  // namespace motorcade
