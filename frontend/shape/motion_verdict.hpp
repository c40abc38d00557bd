#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/shape/existence.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Objects that were known before the viewed one, on which its points may lie instead. Some are beside it; others were
/// lost and would be here by now. A lost one that goes the same way does not count: the viewed object may be it.
class OtherBodies {
 public:
  /// `view.well_before` is known and outlives this.
  OtherBodies(const ObjectView& view, const StereoCamera& camera);

  /// The earlier view for points on the object whose cuboid, grown by `margin_m`, holds a point; null if none does. Its
  /// `T_before_cam` carries the point along with that object instead of leaving it at rest.
  const ObjectView::Before* around(const Eigen::Vector3d& p_cam, double margin_m) const;

 private:
  struct Body {
    Eigen::AlignedBox3d cuboid;
    SE3 T_body_cam;
    ObjectView::Before before;
  };
  std::vector<Body> bodies_;
};

/// True where the tracker measures rest, while the estimate goes on: the track never was on a body, or slipped off it.
/// `sigma_mps` is that of the estimated speed.
bool restsDespiteEstimate(const ObjectEstimate& object, double sigma_mps);

/// Tells whether the image around an object's followed points moved with the body since an earlier frame, or rested.
/// Each point asks the surface around it, densely. That the point itself was followed does not count: a wrong match on
/// what repeats was followed, too. Where a point may lie on an object that was known before, what goes along with that
/// one stands in for what rests. A person with hardly a followed point is asked by its patches, of which most must
/// tell. What rests around it and is nearer tells of a mirror image, and texture that repeats tells of wrong matches.
/// `observed` is null where the object was not measured, `disparities` where no outline of it was found; the frame
/// compared with is `view.well_before`.
MotionVerdict motionVerdict(const ObjectObservation* observed, const LevelDisparities* disparities,
                            const ObjectView& view, const StereoCamera& camera);

}  // namespace motorcade
