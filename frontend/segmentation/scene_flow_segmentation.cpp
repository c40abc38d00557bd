#include "frontend/segmentation/scene_flow_segmentation.hpp"

#include <cmath>
#include <cstdint>
#include <utility>

#include "frontend/segmentation/geometric_constraints.hpp"

namespace motorcade {

SceneFlowSegmentation::SceneFlowSegmentation(const Params& params, const StereoCamera& camera)
    : camera_(camera),
      circular_matching_(params.circular_matching, camera),
      odometry_(params.ego_motion, camera),
      tracks_(params.point_tracks, camera),
      ground_plane_(params.ground_plane),
      segmenter_(params.segmenter, camera),
      disparity_offset_(params.disparity_offset, camera) {}

/// `known`, `observed` and the inliers of the camera's motion have one item per flow observation; the points of the
/// scene are those that are observed.
SceneMotionPtr SceneFlowSegmentation::operator()(const StereoMatchesPtr& stereo, const OpticalFlowPtr& flow) {
  const StereoFrame& frame = *stereo->features->frame;
  if (frame.rejected()) return passOver(frame);

  const auto known = tracks_.known(*flow, odometry_.trail());
  const auto observed = circular_matching_(*stereo, *flow, expectDisparities(known, frame.stamp));
  const CameraMotion camera = odometry_(frame, known, observed);
  tracks_.update(*flow, observed, odometry_.trail());

  auto motion = newMotion(frame, camera);
  motion->features = stereo->features;
  addPoints(observed, camera.inliers, motion->points);
  const std::vector<bool> violates_geometry = testGeometry();
  motion->ground = findGround(violates_geometry, frame.frame, motion->points);
  motion->segments = segmenter_(motion->points, violates_geometry, motion->ground);

  tracks_.setLabels(motion->points);
  motion->disparity_offset_px = disparity_offset_.offset_px();
  calibrateDisparity();
  return motion;
}

SceneMotionPtr SceneFlowSegmentation::passOver(const StereoFrame& rejected) {
  CameraMotion camera = odometry_(rejected, {}, {});
  camera.status = FrameStatus::kRejected;
  return newMotion(rejected, camera);
}

/// In the memory of one that is no longer in use.
std::shared_ptr<SceneMotion> SceneFlowSegmentation::newMotion(const StereoFrame& frame, const CameraMotion& camera) {
  auto motion = motions_.acquire();
  auto points = std::move(motion->points);
  points.clear();
  *motion = SceneMotion{.frame = frame.frame,
                        .stamp = frame.stamp,
                        .status = camera.status,
                        .T_previous_now = camera.T_previous_now,
                        .odometry_covariance = camera.covariance,
                        .ego_inliers = camera.inlier_count,
                        .ground = {},
                        .points = std::move(points),
                        .segments = {},
                        .features = {}};
  return motion;
}

ExpectedDisparities SceneFlowSegmentation::expectDisparities(const std::vector<std::optional<KnownPoint>>& known,
                                                             Timestamp stamp) const {
  const SE3 T_now_previous = odometry_.predict(stamp).inverse();
  ExpectedDisparities expected{.of_point = std::vector<std::optional<ExpectedDisparity>>(known.size()),
                               .motion_known = odometry_.motionKnown(),
                               .offset_px = disparity_offset_.offset_px()};
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!known[i]) continue;
    const double before_px = known[i]->disparity_px;
    const auto at_rest = camera_.project(T_now_previous * known[i]->p_cam);
    expected.of_point[i] = {.before_px = before_px, .at_rest_px = at_rest ? at_rest->z() : before_px};
  }
  return expected;
}

void SceneFlowSegmentation::addPoints(const std::vector<std::optional<StereoObservation>>& observed,
                                      const std::vector<bool>& inliers, std::vector<ScenePoint>& points) const {
  points.reserve(observed.size());
  std::size_t next = 0;
  for (const PointTrack& track : tracks_.observedNow()) {
    while (!observed[next]) ++next;
    const std::size_t i = next++;
    points.push_back({.point = track.point,
                      .uvd_px = track.newest().uvd_px.cast<double>(),
                      .sigma_px = track.newest().sigma_px.cast<double>(),
                      .age = track.count,
                      .ambiguous = track.ambiguity > 0,
                      .ego_inlier = inliers[i],
                      .flow = track.flow});
  }
}

/// Of each point of the scene: does it break the geometry of a static world?
std::vector<bool> SceneFlowSegmentation::testGeometry() const {
  std::vector<bool> violates;
  for (const PointTrack& track : tracks_.observedNow())
    violates.push_back(violatesGeometry(camera_, track, odometry_.trail()));
  return violates;
}

/// Finds the road under the points that do not violate the geometry of a static world, and labels those on it.
GroundPlane SceneFlowSegmentation::findGround(const std::vector<bool>& violates_geometry, FrameId frame,
                                              std::vector<ScenePoint>& points) {
  std::vector<GroundCandidate> candidates;
  std::vector<std::size_t> of_candidate;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (violates_geometry[i]) continue;
    const Eigen::Vector3d p_cam = camera_.triangulate(points[i].uvd_px);
    candidates.push_back({p_cam, std::abs(p_cam.y()) * points[i].sigma_px.z() / points[i].uvd_px.z()});
    of_candidate.push_back(i);
  }
  GroundPlane ground = ground_plane_(candidates, static_cast<std::uint64_t>(frame.value));
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if (ground_plane_.isOnGround(candidates[k])) points[of_candidate[k]].label = PointLabel::kGround;
  return ground;
}

/// Learns from points at rest that were seen at both ends of a window; the disparities remembered follow the offset in
/// use.
void SceneFlowSegmentation::calibrateDisparity() {
  const CameraTrail& trail = odometry_.trail();
  const auto start = disparity_offset_.windowStart(trail.newest().step);
  if (const auto* relation = start ? trail.find(*start) : nullptr)
    disparity_offset_.learn(tracks_.atRestSince(*start), relation->T_then_now.inverse());
  tracks_.shiftDisparities(static_cast<float>(disparity_offset_.advance()));
}

}  // namespace motorcade
