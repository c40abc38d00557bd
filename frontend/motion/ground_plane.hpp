#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// A point that may lie on the road.
struct LowPoint {
  Eigen::Vector3d p_cam;
  double tolerance_m;  // of its height above the plane
};

/// Index of the plane with most support, the first of several. A point near a plane supports it by a truncated
/// quadratic; points below speak against it.
std::size_t mostSupported(std::span<const GroundPlane> planes, std::span<const LowPoint> points);

/// A triangulated point, as far as the road is concerned.
struct GroundCandidate {
  Eigen::Vector3d p_cam;
  double height_sigma_m;  // standard deviation of its height that its disparity leaves
};

/// Finds the road's plane by RANSAC over near, low points and a weighted fit, steadied by the previous frame's plane.
/// Call in frame order: it remembers the last plane.
class GroundPlaneEstimator {
 public:
  struct Params {
    double initial_height_m = 1.65;
    double min_height_m = 0.8, max_height_m = 3.0;  // camera above the road
    double max_tilt_rad = 0.12;                     // between plane normal and the camera's y axis
  };
  explicit GroundPlaneEstimator(const Params& params);

  /// Finds the plane; the caller leaves out points that move. Keeps the last plane when too few points lie on one.
  GroundPlane operator()(std::span<const GroundCandidate> points, std::uint64_t seed);

  /// True when a point lies on the last plane, as far as can be told.
  bool isOnGround(const GroundCandidate& point) const;

 private:
  GroundPlane bestHypothesis(const std::vector<LowPoint>& points, std::uint64_t seed) const;
  bool plausible(const GroundPlane& plane) const;

  Params params_;
  GroundPlane plane_;
};

std::vector<Parameter> parametersOf(GroundPlaneEstimator::Params& params);

}  // namespace motorcade
