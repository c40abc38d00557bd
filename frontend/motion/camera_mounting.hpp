#pragma once

#include <array>
#include <cstddef>

#include "frontend/messages.hpp"

namespace motorcade {

/// How the camera stands over the road: the component-wise median of the planes that were found lately, each by itself.
/// A rig's height and tilt stay the same, so that a plane far from them is a car's roof, an embankment or a reflection.
class CameraMounting {
 public:
  /// Takes a plane that was found without regard to those before it.
  void add(const GroundPlane& found);

  /// True once enough planes were found.
  bool isKnown() const { return count_ >= kLeast; }

  /// Plane of the road under the camera. Requires `isKnown`.
  const GroundPlane& plane() const { return plane_; }

  /// Likelihood of a plane, 1 of the mounting's own, with heavy tails: a ramp that is surely seen is believed. It is 1
  /// of all planes while the mounting is not known.
  double likelihoodOf(const GroundPlane& plane) const;

 private:
  static constexpr std::size_t kLeast = 5, kRemembered = 256;

  std::array<GroundPlane, kRemembered> found_;  // a ring
  std::size_t count_ = 0;                       // of all planes so far
  GroundPlane plane_;
};

}  // namespace motorcade
