#pragma once

#include <optional>
#include <vector>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/region_flow.hpp"
#include "frontend/tracking/search_by_projection.hpp"

namespace motorcade {

/// True when what lies to both sides of a box has another depth than what the box shows: it ends where its body does.
bool standsOut(const Box& box, double disparity_px, const SceneMotion& scene, int most_patches = kMostPatches);

/// Part of the image that may show a person's trunk and head, around a scene point.
struct TrunkWindow {
  int point = 0;  // index into `SceneMotion::points`
  Box box;
  RegionPixels pixels;
};

/// Looks for people without labels. Corners on somebody are few, and few of them are followed for long; but each tells
/// how large a person is there. Around one that contradicts the camera's motion, a window of that size must stand out
/// from its surroundings in depth, and must not look as it would at rest.
class TrunkWindows {
 public:
  /// `flow` outlives it.
  TrunkWindows(const RegionFlow& flow, const StereoCamera& camera) : flow_(flow), camera_(camera) {}

  /// Windows of a frame. Points that lie at an object, or that a label shows, have none.
  std::vector<TrunkWindow> operator()(const SceneMotion& scene, const std::vector<bool>& on_objects,
                                      const SE3& T_world_cam) const;

 private:
  bool mayBeOnTrunk(const ScenePoint& point, const GroundPlane& ground) const;
  std::optional<RegionPixels> moving(const Box& box, double disparity_px, const SceneMotion& scene,
                                     const SE3& T_world_cam) const;
  Box boxAround(const ScenePoint& point, double aside_m, const GroundPlane& ground) const;

  const RegionFlow& flow_;
  StereoCamera camera_;
};

}  // namespace motorcade
