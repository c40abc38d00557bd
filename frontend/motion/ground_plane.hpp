#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/camera_mounting.hpp"

namespace motorcade {

/// A point that may lie on the road.
struct LowPoint {
  Eigen::Vector3d p_cam;
  double tolerance_m;  // of its height above the plane
};

/// Support of each plane, in points. A point near a plane supports it by a truncated quadratic; points below speak
/// against it.
std::vector<double> planeSupports(std::span<const GroundPlane> planes, std::span<const LowPoint> points);

/// A triangulated point, as far as the road is concerned.
struct GroundCandidate {
  Eigen::Vector3d p_cam;
  double depth_ratio;  // relative standard deviation of its disparity, and so of its depth
};

/// Finds the road's plane by RANSAC over near, low points and a weighted fit. How the camera is mounted and the plane
/// of the frame before steady it. Call in frame order.
class GroundPlaneEstimator {
 public:
  struct Params {
    double initial_height_m = 1.65;
    double min_height_m = 0.3, max_height_m = 4.5;  // camera above the road
    double max_tilt_rad = 0.5;                      // between plane normal and the camera's y axis
  };
  explicit GroundPlaneEstimator(const Params& params);

  /// Finds the plane; the caller leaves out points that move. Keeps the last plane when too few points lie on one.
  GroundPlane operator()(std::span<const GroundCandidate> points, std::uint64_t seed);

  /// Mounting of the camera over the road, as far as it is known.
  const GroundPlane& mounting() const { return mounting_.plane(); }

  /// True when a point lies on the last plane, as far as can be told.
  bool isOnGround(const GroundCandidate& point) const;

 private:
  struct Hypotheses {
    std::vector<LowPoint> low;
    std::vector<GroundPlane> planes;
    std::vector<double> supports;
  };
  Hypotheses hypothesesBelow(GroundPlane road, std::span<const GroundCandidate> points, std::uint64_t seed) const;
  std::optional<GroundPlane> fitted(const Hypotheses& hypotheses, const std::vector<double>& scores) const;
  std::optional<GroundPlane> fittedAnywhere(std::span<const GroundCandidate> points, std::uint64_t seed) const;
  bool plausible(const GroundPlane& plane) const;
  double heightSigma_m(const GroundCandidate& point) const;

  Params params_;
  GroundPlane plane_;
  CameraMounting mounting_;
};

std::vector<Parameter> parametersOf(GroundPlaneEstimator::Params& params);

}  // namespace motorcade
