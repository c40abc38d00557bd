#include "apps/check/camera_doubts.hpp"

#include <cstdio>

namespace motorcade {
namespace {

constexpr double kLeastBaseline_m = 0.05, kMostBaseline_m = 2;
constexpr double kLeastFocal = 0.2, kMostFocal = 10;  // focal length over image width: 136 and 6 degrees wide

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

}  // namespace motorcade
