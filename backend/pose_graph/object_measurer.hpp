#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "backend/motion/body_view.hpp"
#include "backend/motion/camera_path.hpp"
#include "backend/pose_graph/body_map.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Measures encounters and motions of objects from their points, in place of those that the front-end concluded. It
/// takes from the front-end only where a body's frame lies at first, which is a choice, not a measurement.
///
/// No measurement of a point enters two factors. Three quarters of the points, by their ids, measure encounters,
/// against the body's map. The last quarter measures motions, half of it into even frames, the other half into odd
/// ones: a motion takes a point's measurements of two frames, so each is taken once. With few points all of them
/// measure the encounter, and there is no motion. Ids decide, so that a point has the same role in all frames. Two
/// equal halves were a tenth worse on three scenes, and elsewhere the same.
class ObjectMeasurer {
 public:
  explicit ObjectMeasurer(const StereoCamera& camera) : camera_(camera) {}

  /// Returns the same measurements with new poses, motions and covariances of objects. Call in frame order.
  /// Observations without points are left as they are.
  FrameMeasurements operator()(const FrameMeasurements& measurements);

 private:
  struct Body {
    FrameId frame;  // of the last observation
    std::vector<PointMeasurement> points;
    double disparity_offset_px = 0;
    SE3 T_cam_body;
    Vector6d twist = Vector6d::Zero();  // a mean over the last frames, for what is expected [m/s, rad/s]
    BodyMap map;

    BodyView view() const { return {frame, points, disparity_offset_px, T_cam_body}; }
  };
  void measure(ObjectObservation& seen, double disparity_offset_px);
  void start(ObjectObservation& seen, double disparity_offset_px);
  void follow(Body& body, ObjectObservation& seen, double disparity_offset_px) const;
  std::optional<PointSetFit> fit(const Body& body, const BodyView& expected,
                                 const std::function<bool(PointId)>& uses) const;
  SE3 expectedPose(const Body& body, FrameId frame) const;
  void remember(Body& body, const BodyView& now, const Matrix6d& covariance) const;

  StereoCamera camera_;
  CameraPath path_;
  std::map<TrackId, Body> bodies_;
};

}  // namespace motorcade
