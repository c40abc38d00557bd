#include "apps/check/camera_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace motorcade {
namespace {

/// The least baseline excludes one that was written into P1 without the focal length (0.54 m / 721 px is 0.7 mm, 2 m /
/// 700 px is 2.9 mm). The closest pairs on sale are 18 mm apart (RealSense D405).
/// The largest exceeds the width of road vehicles, 2.55 m; centimeters and millimeters taken for meters lie above it.
constexpr double kLeastBaseline_m = 0.003, kMostBaseline_m = 2.6;
constexpr double kLeastFocal = 0.2, kMostFocal = 10;  // focal length over image width: 136 and 6 degrees wide

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// The principal point as shares of the image's size.
struct Middle {
  double across, down;
};

Middle middleOf(const StereoCamera& camera) {
  return {camera.cx_px / camera.width_px, camera.cy_px / camera.height_px};
}

bool isOutside(const Middle& middle) {
  return middle.across <= 0 || middle.across >= 1 || middle.down <= 0 || middle.down >= 1;
}

bool isFar(double share) { return share < 0.3 || share > 0.7; }

/// True when the calibration seems to be of larger or smaller images, which moves both shares alike. Images with a side
/// cut off, or two in one, move the horizontal share; nobody cuts off so much there. Sky or bonnet cut off moves the
/// vertical share alone, which is fine.
bool isOfAnotherSize(const Middle& middle) {
  constexpr double kAlike = 0.12;
  const bool both = std::min(middle.across, middle.down) > 0.65 || std::max(middle.across, middle.down) < 0.35;
  return isFar(middle.across) || (both && std::abs(middle.across - middle.down) < kAlike);
}

}  // namespace

std::vector<std::string> doubtsAbout(const StereoCamera& camera) {
  std::vector<std::string> doubts;
  if (!(camera.baseline_m >= kLeastBaseline_m && camera.baseline_m <= kMostBaseline_m))
    doubts.push_back("the calibration tells a baseline of " + text("%.4g", camera.baseline_m) +
                     " m; its translations must be in meters (P1: -fx times the baseline)");
  const double focal = camera.fx_px / camera.width_px;
  if (!(focal >= kLeastFocal && focal <= kMostFocal))
    doubts.push_back(
        text("the calibration tells a focal length of %.4g px for images %d px wide; is it that of "
             "another image size?",
             camera.fx_px, camera.width_px));
  const Middle middle = middleOf(camera);
  if (isOutside(middle))
    doubts.push_back(
        text("the calibration's principal point (%.5g, %.5g) lies outside the image; is it that of "
             "another image size?",
             camera.cx_px, camera.cy_px));
  else if (isOfAnotherSize(middle))
    doubts.push_back(
        text("the calibration's principal point (%.5g, %.5g) lies far from the middle of images of "
             "%dx%d px; is it that of another image size?",
             camera.cx_px, camera.cy_px, camera.width_px, camera.height_px));
  return doubts;
}

std::vector<std::string> odditiesOf(const StereoCamera& camera) {
  constexpr double kLeastShare = 0.2, kMostShare = 0.8, kMostUnlike = 1.1;
  std::vector<std::string> oddities;
  const Middle middle = middleOf(camera);
  if (!isOutside(middle) && !isOfAnotherSize(middle) && (middle.down < kLeastShare || middle.down > kMostShare))
    oddities.push_back(
        text("the calibration's principal point lies in row %.5g of images %d px high: right where much "
             "of the sky or the bonnet is cut off, and cy was lessened by what is cut off above",
             camera.cy_px, camera.height_px));
  const double unlike = std::max(camera.fx_px, camera.fy_px) / std::min(camera.fx_px, camera.fy_px);
  if (unlike > kMostUnlike)
    oddities.push_back(
        text("the calibration's focal lengths differ by %.0f %% (fx %.5g, fy %.5g px): right where images "
             "were squeezed; the order is fx, fy, cx, cy",
             100 * (unlike - 1), camera.fx_px, camera.fy_px));
  return oddities;
}

}  // namespace motorcade
