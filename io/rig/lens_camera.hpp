#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "io/images/image_file.hpp"

namespace motorcade {

enum class Distortion { kNone, kRadialTangential, kEquidistant };

/// A pinhole camera with a lens that distorts, as calibrations give it.
struct LensCamera {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  Distortion distortion = Distortion::kNone;
  /// Radial-tangential: k1 k2 p1 p2 k3 k4 k5 k6, as OpenCV orders them; equidistant: k1 k2 k3 k4.
  std::array<double, 8> coefficients{};
  ImageSize size{};  // of its images; empty where the calibration does not tell
};

/// Projection of a lens and its inverse. Rays are in the camera's own frame: x right, y down, z ahead.
class LensModel {
 public:
  explicit LensModel(const LensCamera& camera);

  /// Empty for a ray from behind, and for one so far aside that the lens polynomial no longer grows. Such rays would
  /// fold back into the image.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray) const;
  /// A ray with z = 1, or of length 1 through an equidistant lens. Empty for a pixel that no ray reaches.
  std::optional<Eigen::Vector3d> rayThrough(const Eigen::Vector2d& pixel_px) const;

 private:
  /// Distance from the middle of the image, in focal lengths. The argument is the ray's distance: its tangent, or its
  /// angle with an equidistant lens.
  double distorted(double undistorted) const { return undistorted * factor(undistorted * undistorted); }
  double factor(double squared) const;
  std::optional<double> undistorted(double distorted) const;
  Eigen::Vector2d tangential(const Eigen::Vector2d& point) const;
  double limit() const;

  LensCamera camera_;
  bool rational_;  // whether k4 to k6 matter
  double limit_;   // up to which the distorted distance grows
};

}  // namespace motorcade
