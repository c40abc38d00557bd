#pragma once

#include <optional>
#include <span>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Place of some points in the image, and how near they are.
struct PointRegion {
  Box box;
  double disparity_px;  // the median
};

/// The region around points; empty without points.
std::optional<PointRegion> regionOf(std::span<const ScenePoint* const> points);

/// True when the background is seen between two groups of points, so that they lie on two bodies. A body is convex but
/// for details: nothing between two of its places is farther than the line between these.
bool isSeenThrough(const SceneMotion& scene, const PointRegion& a, const PointRegion& b, const StereoCamera& camera);

/// Tells whether the background parts something from an object that moves alike: people walk in groups, and the street
/// is seen between them. Larger and faster objects are never parted, as one sees through the windows of vehicles.
class SeeThrough {
 public:
  /// Both outlive it.
  SeeThrough(const SceneMotion& scene, const StereoCamera& camera) : scene_(scene), camera_(camera) {}

  /// The region of an object's points in the scene; empty where it is no small body or none of them is seen.
  std::optional<PointRegion> regionOf(const TrackedObject& object) const;
  bool areApart(const TrackedObject& a, const TrackedObject& b) const;
  bool isApart(const TrackedObject& object, const MotionComponent& component) const;
  /// True when the background is seen between two objects of any size.
  bool isGapBetween(const TrackedObject& a, const TrackedObject& b) const;

 private:
  std::optional<PointRegion> seenRegionOf(const TrackedObject& object) const;

  const SceneMotion& scene_;
  const StereoCamera& camera_;
};

}  // namespace motorcade
