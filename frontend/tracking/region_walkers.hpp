#pragma once

#include <optional>
#include <vector>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/look_back.hpp"
#include "frontend/tracking/region_flow.hpp"

namespace motorcade {

/// Looks for people on foot, and on bicycles that come or go, where an instance label or depth shows what may be one.
/// Corners are few on clothes, and none may be followed for long; a region can be looked for as a whole. It proves
/// nothing by itself: what does not surely move is left alone, whatever it shows.
class RegionWalkers {
 public:
  /// `past` outlives it.
  RegionWalkers(const LookBack& past, const StereoCamera& camera) : camera_(camera), flow_of_(past, camera) {}

  /// Somebody who walks or rides, with the number of frames and the time over which that was seen.
  struct Mover {
    MotionComponent component;
    int frames = 0;
    double duration_s = 0;
    bool labelled = false;
  };
  /// A region that has a person's size at the depth of its points.
  struct Candidate {
    InstanceRegion region;    // its label is 0 where none shows it
    std::vector<int> points;  // indices into `SceneMotion::points`
    double disparity_px = 0;  // the points' median
    RegionPixels pixels{};
  };
  /// Candidates of a frame: what labels show, in their order, and what stands out in depth. Where labels are too many,
  /// some of them are candidates, and others in the next frame. A label with a point that is `taken` by an object is no
  /// candidate. Points that lie at an object lead to none.
  std::vector<Candidate> candidates(const SceneMotion& scene, const std::vector<bool>& taken,
                                    const std::vector<bool>& on_objects, const SE3& T_world_cam) const;
  /// Mover that a candidate is; empty where nobody surely moves.
  std::optional<Mover> operator()(const Candidate& candidate, const SceneMotion& scene, const SE3& T_world_cam) const;

 private:
  std::vector<Candidate> labelled(const SceneMotion& scene, const std::vector<bool>& taken) const;
  bool mayBeOn(const SceneFlow& person, const ScenePoint& point) const;
  bool isLikeAPerson(const InstanceRegion& region, double disparity_px) const;

  StereoCamera camera_;
  RegionFlow flow_of_;
};

}  // namespace motorcade
