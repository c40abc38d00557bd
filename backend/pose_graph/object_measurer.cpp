#include "backend/pose_graph/object_measurer.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kSplitPoints = 24;  // from here on, an eighth of them can measure a motion
constexpr double kTwistGain = 0.3;        // of the newest motion in the mean: expectations need not be better
/// Deviation of the first encounter, which defines the body's frame: next to nothing beside any measurement.
constexpr double kDefined = 1e-3;  // m, rad

bool any(PointId) { return true; }
bool measuresMotions(PointId point) { return point.value % 4 == 3; }
bool measuresEncounters(PointId point) { return !measuresMotions(point); }
/// True for a point that measures the motion into a frame: each point's measurements of two successive frames serve one
/// motion.
bool measuresMotionInto(FrameId frame, PointId point) {
  return measuresMotions(point) && (point.value / 4) % 2 == frame.value % 2;
}

}  // namespace

FrameMeasurements ObjectMeasurer::operator()(const FrameMeasurements& measurements) {
  FrameMeasurements measured = measurements;
  path_.add(measurements);
  for (ObjectObservation& seen : measured.objects) measure(seen, measurements.disparity_offset_px);
  for (const TrackId track : measurements.ended) bodies_.erase(track);
  return measured;
}

void ObjectMeasurer::measure(ObjectObservation& seen, double disparity_offset_px) {
  if (!path_.find(seen.frame)) return;
  const auto body = bodies_.find(seen.track);
  const bool is_known = body != bodies_.end() && path_.find(body->second.frame);
  const bool observed = seen.state != ObjectState::kPredicted && !seen.measured.empty() && isFinite(seen.T_cam_body);
  if (is_known && observed)
    follow(body->second, seen, disparity_offset_px);
  else if (is_known && seen.state == ObjectState::kPredicted)
    seen.T_cam_body = expectedPose(body->second, seen.frame);
  else if (observed)
    start(seen, disparity_offset_px);
}

void ObjectMeasurer::start(ObjectObservation& seen, double disparity_offset_px) {
  Body& body = bodies_[seen.track] = Body{};
  body.twist.head<3>() = seen.T_cam_body.rotation().transpose() * seen.velocity_cam_mps;
  seen.encounter_covariance = kDefined * kDefined * Matrix6d::Identity();
  seen.motion.reset();
  body.frame = seen.frame;
  remember(body, {seen.frame, seen.measured, disparity_offset_px, seen.T_cam_body}, Matrix6d::Zero());
}

/// Pose at constant twist from the last observation.
SE3 ObjectMeasurer::expectedPose(const Body& body, FrameId frame) const {
  const auto *then = path_.find(body.frame), *now = path_.find(frame);
  const double dt_s = secondsBetween(then->stamp, now->stamp);
  return now->T_world_cam.inverse() * then->T_world_cam * body.T_cam_body * SE3::exp(dt_s * body.twist);
}

std::optional<PointSetFit> ObjectMeasurer::fit(const Body& body, const BodyView& expected,
                                               const std::function<bool(PointId)>& uses) const {
  const std::vector<SeenPoint> points = body.map.seenIn(expected, uses);
  if (points.size() < kLeastPoints) return std::nullopt;
  return fitPointSet(camera_, points, looselyExpected(expected.T_cam_body));
}

void ObjectMeasurer::follow(Body& body, ObjectObservation& seen, double disparity_offset_px) const {
  BodyView now{seen.frame, seen.measured, disparity_offset_px, expectedPose(body, seen.frame)};
  const ExpectedPose expected = looselyExpected(now.T_cam_body);
  const PointSetFit nothing{expected.T_cam_ref, expected.sigma.cwiseAbs2().asDiagonal()};
  const bool split = body.map.seenIn(now, any).size() >= kSplitPoints;
  const PointSetFit pose = fit(body, now, any).value_or(nothing);
  const PointSetFit encounter = split ? fit(body, now, measuresEncounters).value_or(nothing) : pose;
  now.T_cam_body = pose.T_cam_ref;
  seen.motion.reset();
  if (split)
    seen.motion = motionBetween(camera_, body.view(), now, path_,
                                [&](PointId point) { return measuresMotionInto(seen.frame, point); });
  seen.T_cam_body = encounter.T_cam_ref;
  seen.encounter_covariance = encounter.covariance;
  remember(body, now, pose.covariance);
}

void ObjectMeasurer::remember(Body& body, const BodyView& now, const Matrix6d& covariance) const {
  const auto *from = path_.find(body.frame), *to = path_.find(now.frame);
  const double dt_s = secondsBetween(from->stamp, to->stamp);
  if (dt_s > 0) {
    const SE3 T_before_now = (from->T_world_cam * body.T_cam_body).inverse() * to->T_world_cam * now.T_cam_body;
    body.twist += kTwistGain * (T_before_now.log() / dt_s - body.twist);
  }
  body.map.update(camera_, now, covariance);
  body.frame = now.frame;
  body.points.assign(now.points.begin(), now.points.end());
  body.disparity_offset_px = now.disparity_offset_px;
  body.T_cam_body = now.T_cam_body;
}

}  // namespace motorcade
