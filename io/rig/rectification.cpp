#include "io/rig/rectification.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

/// Bounds of a picture at distance one.
struct Frame {
  double left, top, right, bottom;
};

[[noreturn]] void failLeftOf(const Rig& rig) {
  const std::string transform = rig.transform.empty() ? "the transform" : rig.transform;
  throw InputError(rig.file.string() + ": the second camera stands to the left of the first (x is " +
                   std::to_string(rig.T_right_left.translation().x()) + " m): either " + transform +
                   " is the inverse of what is meant, which takes points of the left camera to the right one and has a "
                   "negative x; then invert it. Or the cameras are exchanged; then exchange images and calibration");
}

/// Both cameras' axes in the frame of the raw left one, and how far apart they are.
struct Axes {
  Eigen::Matrix3d R_rectified_left;
  double baseline_m;
};

Axes commonAxes(const Rig& rig) {
  constexpr double kLeastBaseline_m = 1e-6, kMostTurn = 0.8, kLeastAhead = 0.5;  // cosines
  const Eigen::Vector3d right_center = rig.T_right_left.inverse().translation();
  const double baseline_m = right_center.norm();
  if (!(baseline_m > kLeastBaseline_m))
    throw InputError(rig.file.string() + ": both cameras stand at the same place: the translation between them is 0");
  const Eigen::Vector3d x = right_center / baseline_m;
  if (x.x() < -kMostTurn) failLeftOf(rig);
  if (x.x() < kMostTurn)
    throw InputError(rig.file.string() +
                     ": the second camera does not stand to the right of the first (translation in the first one's "
                     "axes, x right, y down, z ahead: " +
                     std::to_string(right_center.x()) + " " + std::to_string(right_center.y()) + " " +
                     std::to_string(right_center.z()) + " m); only pairs side by side are followed" +
                     (rig.transform.empty() ? "" : ". Is " + rig.transform + " the inverse of what is meant?"));
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ() + rig.T_right_left.rotation().row(2).transpose();
  if (!(ahead.cross(x).norm() > kLeastAhead))
    throw InputError(rig.file.string() + ": the two cameras see nothing in common; one looks where the other does not");
  const Eigen::Vector3d y = ahead.cross(x).normalized();
  Eigen::Matrix3d R_rectified_left;
  R_rectified_left << x.transpose(), y.transpose(), x.cross(y).transpose();
  return {R_rectified_left, baseline_m};
}

/// The largest frame that one camera fills: the innermost points of each of its image's edges.
Frame filledFrame(const LensCamera& camera, const Eigen::Matrix3d& R, ImageSize size) {
  constexpr double kFar = 10;  // beyond 84 degrees aside nothing is worth having
  constexpr int kSteps = 128;
  const LensModel lens(camera);
  Frame frame{-kFar, -kFar, kFar, kFar};
  const auto seen = [&](double u, double v) -> std::optional<Eigen::Vector2d> {
    const auto ray = lens.rayThrough({u, v});
    if (!ray) return std::nullopt;
    const Eigen::Vector3d turned = R * *ray;
    if (!(turned.z() * kFar > turned.head<2>().norm())) return std::nullopt;
    return Eigen::Vector2d(turned.x() / turned.z(), turned.y() / turned.z());
  };
  for (int i = 0; i <= kSteps; ++i) {
    const double right = size.width - 1, bottom = size.height - 1;
    const double u = right * i / kSteps, v = bottom * i / kSteps;
    if (const auto p = seen(0, v)) frame.left = std::max(frame.left, p->x());
    if (const auto p = seen(right, v)) frame.right = std::min(frame.right, p->x());
    if (const auto p = seen(u, 0)) frame.top = std::max(frame.top, p->y());
    if (const auto p = seen(u, bottom)) frame.bottom = std::min(frame.bottom, p->y());
  }
  return frame;
}

/// The shortest focal length with which an image lies within the frame.
StereoCamera cameraWithin(const Frame& frame, ImageSize size, double least_focal_px) {
  const double right = size.width - 1, bottom = size.height - 1;
  const double focal_px =
      std::max({right / (frame.right - frame.left), bottom / (frame.bottom - frame.top), least_focal_px});
  return {.fx_px = focal_px,
          .fy_px = focal_px,
          .cx_px = 0.5 * (right - focal_px * (frame.left + frame.right)),
          .cy_px = 0.5 * (bottom - focal_px * (frame.top + frame.bottom)),
          .width_px = size.width,
          .height_px = size.height};
}

void requireSize(const Rig& rig, ImageSize size) {
  for (const LensCamera* camera : {&rig.left, &rig.right})
    if (camera->size != ImageSize{} && camera->size != size)
      throw InputError(rig.file.string() + ": is of images of " + camera->size.text() + " pixels, these have " +
                       size.text() + "; calibrate anew, or take the images of the calibrated size");
}

/// Throws InputError if a calibration that gives no image size was made for another one. A larger or smaller size moves
/// both coordinates of the principal point alike.
void requireMiddle(const Rig& rig, ImageSize size) {
  constexpr double kLeast = 0.35, kMost = 0.65;
  for (const LensCamera* camera : {&rig.left, &rig.right}) {
    if (camera->size != ImageSize{}) continue;
    const double across = camera->cx_px / size.width, down = camera->cy_px / size.height;
    if (std::max(across, down) < kLeast || std::min(across, down) > kMost)
      throw InputError(rig.file.string() + ": its principal point (" + std::to_string(camera->cx_px) + ", " +
                       std::to_string(camera->cy_px) + ") is not that of images of " + size.text() +
                       " pixels; is it that of another image size?");
  }
}

}  // namespace

Rectification rectificationOf(const Rig& rig, ImageSize size) {
  requireSize(rig, size);
  requireMiddle(rig, size);
  if (rig.rectified) {
    Rectification none{.left = rig.left, .right = rig.right, .camera = *rig.rectified};
    none.camera.width_px = size.width;
    none.camera.height_px = size.height;
    return none;
  }
  if (rig.given) {
    Rectification given = *rig.given;
    given.camera.width_px = size.width;
    given.camera.height_px = size.height;
    return given;
  }
  const auto [R_rectified_left, baseline_m] = commonAxes(rig);
  Rectification result{.left = rig.left,
                       .right = rig.right,
                       .R_left = R_rectified_left,
                       .R_right = R_rectified_left * rig.T_right_left.rotation().transpose()};
  const Frame left = filledFrame(rig.left, result.R_left, size), right = filledFrame(rig.right, result.R_right, size);
  const Frame both{std::max(left.left, right.left), std::max(left.top, right.top), std::min(left.right, right.right),
                   std::min(left.bottom, right.bottom)};
  if (!(both.left < both.right) || !(both.top < both.bottom))
    throw InputError(rig.file.string() + ": the two cameras see nothing in common");
  const double focal_px = 0.25 * (rig.left.fx_px + rig.left.fy_px + rig.right.fx_px + rig.right.fy_px);
  result.camera = cameraWithin(both, size, kLeastZoom * focal_px);
  result.camera.baseline_m = baseline_m;
  return result;
}

}  // namespace motorcade
