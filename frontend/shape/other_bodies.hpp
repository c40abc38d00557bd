#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "core/stereo_camera.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// The objects that were known before the one that is viewed, on which its points may lie instead: those beside it, and
/// those that were lost and would be here by now, unless they go the same way, as it may be one of them.
class OtherBodies {
 public:
  /// `view.well_before` is known and outlives this.
  OtherBodies(const ObjectView& view, const StereoCamera& camera);

  /// What goes along with the object within whose cuboid, grown by `margin_m`, a point lies, in place of what rests;
  /// null where it lies within none.
  const ObjectView::Before* around(const Eigen::Vector3d& p_cam, double margin_m) const;

 private:
  struct Body {
    Eigen::AlignedBox3d cuboid;
    SE3 T_body_cam;
    ObjectView::Before before;
  };
  std::vector<Body> bodies_;
};

}  // namespace motorcade
