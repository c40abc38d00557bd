#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "frontend/messages.hpp"

namespace motorcade {

/// Mounting of the camera over the road: the component-wise median of the planes of the last frames, each found by
/// itself. A rig's height and tilt stay the same. So a plane far from them is a car's roof, an embankment or a mirror
/// image.
class CameraMounting {
 public:
  /// The mounting is `assumed` until enough planes were found.
  explicit CameraMounting(const GroundPlane& assumed) : assumed_(assumed) {}

  /// Takes a plane that was found without regard to those before it.
  void add(const GroundPlane& found);

  /// True once enough planes were found.
  bool isKnown() const { return count_ >= kLeast; }

  /// Plane of the road under the camera.
  const GroundPlane& plane() const { return isKnown() ? median_ : assumed_; }

  /// Likelihood of a plane, which is 1 as near to the mounting as is usual. Its tails are heavy: a ramp that is surely
  /// seen is believed.
  double likelihoodOf(const GroundPlane& plane) const;

 private:
  static constexpr std::size_t kLeast = 5, kRemembered = 256;

  std::array<GroundPlane, kRemembered> found_;  // a ring
  std::size_t count_ = 0;                       // of all planes so far
  GroundPlane assumed_, median_;
};

/// Axes of a camera over a road, in columns: x to the right, y down to the road, z ahead. For a normal near the
/// camera's y axis.
Eigen::Matrix3d levelAxes(const Eigen::Vector3d& normal_cam);

}  // namespace motorcade
