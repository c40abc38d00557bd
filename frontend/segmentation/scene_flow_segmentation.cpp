#include "frontend/segmentation/scene_flow_segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "frontend/segmentation/geometric_constraints.hpp"

namespace motorcade {
namespace {

constexpr double kGapIntervals = 1.5;  // since the last frame that was seen: frames are missing
// Between frames of a sparse drive: optical flow lets points wait for a better image up to the first, and none wait
// beyond the second.
constexpr double kSparse_s = 0.15, kMaxWaiting_s = 0.5;
// Flow over a gap is trusted when so many points agree on a motion, and such a share of those that were followed.
constexpr int kSureInliers = 60;
constexpr double kSureShare = 0.6;

bool isSure(const CameraMotion& camera) {
  return camera.status == FrameStatus::kGood && camera.inlier_count >= kSureInliers &&
         camera.inlier_count >= kSureShare * camera.measured_count;
}

/// Compares two measurements of a motion over a gap: they differ by noise, or one of them is wrong.
bool agree(const SE3& a, const SE3& b) {
  constexpr double kApart_m = 0.5, kApart_rad = 0.02;
  const Vector6d apart = (a.inverse() * b).log();
  return apart.head<3>().norm() < kApart_m && apart.tail<3>().norm() < kApart_rad;
}

/// Leaves out ignored points. It looks in the right image, too: what is fixed to the camera hides there what the left
/// one sees.
void leaveOut(const PixelMask& ignored, std::vector<std::optional<StereoObservation>>& observed) {
  for (auto& seen : observed) {
    if (!seen) continue;
    const float u_px = seen->uvd_px.x(), v_px = seen->uvd_px.y(), d_px = seen->uvd_px.z();
    if (ignored.holds(u_px, v_px) || ignored.holds(u_px - d_px, v_px)) seen.reset();
  }
}

void addInstances(const InstanceLabels& labels, std::vector<ScenePoint>& points) {
  for (ScenePoint& point : points) point.instance = labels.at(point.uvd_px.x(), point.uvd_px.y());
}

/// Merges the observations, ordered by point; where both have a point, that of the flow.
OpticalFlow merged(const OpticalFlow& flow, const std::vector<FlowObservation>& found) {
  OpticalFlow all{.features = flow.features, .observations = {}};
  std::ranges::set_union(flow.observations, found, std::back_inserter(all.observations), {}, &FlowObservation::point,
                         &FlowObservation::point);
  return all;
}

/// The points that flow lost. Both are ordered by point.
std::vector<RestingPoint> without(const OpticalFlow& flow, const std::vector<RestingPoint>& points) {
  std::vector<RestingPoint> lost;
  auto followed = flow.observations.begin();
  for (const RestingPoint& point : points) {
    followed = std::ranges::lower_bound(followed, flow.observations.end(), point.point, {}, &FlowObservation::point);
    if (followed == flow.observations.end() || followed->point != point.point) lost.push_back(point);
  }
  return lost;
}

}  // namespace

SceneFlowSegmentation::SceneFlowSegmentation(const Params& params, const StereoCamera& camera)
    : camera_(camera),
      circular_matching_(params.circular_matching, camera),
      odometry_(params.ego_motion, camera),
      gap_bridge_(params.ego_motion, camera),
      own_vehicle_(camera),
      tracks_(params.point_tracks, camera),
      ground_plane_(params.ground_plane),
      segmenter_(params.segmenter, camera),
      disparity_offset_(params.disparity_offset, camera) {}

/// Observations and the inliers of the camera's motion have one item per flow observation; the points of the scene are
/// those that are observed and belong to the world.
SceneMotionPtr SceneFlowSegmentation::operator()(const StereoMatchesPtr& stereo, const OpticalFlowPtr& flow) {
  const StereoFrame& frame = *stereo->features->frame;
  odometry_.hear(frame.inputs, frame.head.stamp);
  if (frame.rejected() || flow->observations.empty()) return passOver(frame);

  const MeasuredFrame measured = measure(*stereo, *flow);
  if (mayBeABadImage(measured.camera, frame.head.stamp)) return passOver(frame);
  const Odometry odometry = odometry_.add(frame.head.stamp, measured.camera);
  const Observations of_world = learnOwnVehicle(measured);
  tracks_.update(measured.flow, of_world, odometry_.trail());

  FrameHead head = frame.head;
  head.status = measured.camera.status;
  head.cause = measured.camera.cause;
  auto motion = newMotion(head, odometry);
  motion->features = stereo->features;
  motion->ego_inliers = measured.camera.inlier_count;
  motion->disparity_offset_px = disparity_offset_.offset_px();
  addPoints(of_world, measured.camera.inliers, motion->points);
  if (frame.inputs.instances) addInstances(*frame.inputs.instances, motion->points);
  const std::vector<bool> violates_geometry = testGeometry();
  motion->ground = findGround(violates_geometry, *motion);
  odometry_.levelBy(ground_plane_.mounting());
  motion->components = segmenter_(motion->points, violates_geometry, motion->ground, motion->camera_speed_mps);

  tracks_.setLabels(motion->points);
  calibrateDisparity();
  return motion;
}

SceneFlowSegmentation::MeasuredFrame SceneFlowSegmentation::measure(const StereoMatches& stereo,
                                                                    const OpticalFlow& flow) const {
  const Timestamp stamp = stereo.features->frame->head.stamp;
  const PredictedMotion predicted = odometry_.predict(stamp);
  MeasuredFrame measured = measure(stereo, flow, predicted);
  if (measured.camera.status == FrameStatus::kGood && !isAfterGap(stamp)) return measured;
  return bridged(stereo, std::move(measured), predicted);
}

SceneFlowSegmentation::MeasuredFrame SceneFlowSegmentation::measure(const StereoMatches& stereo,
                                                                    const OpticalFlow& flow,
                                                                    const PredictedMotion& predicted) const {
  const StereoFrame& frame = *stereo.features->frame;
  const auto known = tracks_.known(flow, odometry_.trail());
  auto all = circular_matching_(stereo, flow, expectDisparities(known, frame.head.stamp, predicted.T_seen_now));
  auto of_world = all;
  if (frame.inputs.ignored) leaveOut(*frame.inputs.ignored, of_world);
  own_vehicle_.leaveOut(flow, of_world);
  CameraMotion camera = odometry_.measure(frame, known, of_world, predicted);
  return {flow, std::move(all), std::move(of_world), std::move(camera)};
}

/// Learns the own vehicle, and returns the observations without what this frame shows of it.
SceneFlowSegmentation::Observations SceneFlowSegmentation::learnOwnVehicle(const MeasuredFrame& measured) {
  Observations of_world = measured.of_world;
  if (measured.camera.status != FrameStatus::kGood) {
    own_vehicle_.forgetPoints();
  } else {
    own_vehicle_.learn(measured.flow, measured.all, odometry_.trail());
    own_vehicle_.leaveOut(measured.flow, of_world);
  }
  return of_world;
}

/// True when frames are missing before this one.
bool SceneFlowSegmentation::isAfterGap(Timestamp stamp) const {
  const CameraTrail& trail = odometry_.trail();
  if (trail.empty()) return false;
  const auto* before = trail.find(trail.newest().step - 1);
  return before && secondsBetween(trail.newest().stamp, stamp) > -kGapIntervals * before->dt_s;
}

/// One frame of a sparse drive that is not linked to the last one: the next one may be.
bool SceneFlowSegmentation::mayBeABadImage(const CameraMotion& camera, Timestamp stamp) const {
  if (camera.status == FrameStatus::kGood || odometry_.trail().empty() || isAfterGap(stamp)) return false;
  const double since_s = secondsBetween(odometry_.trail().newest().stamp, stamp);
  return since_s > kSparse_s && since_s < kMaxWaiting_s;
}

/// Finds the points of the last frame that was seen again, where optical flow lost them, and measures the motion anew.
/// Where that fails, the motion is not known.
SceneFlowSegmentation::MeasuredFrame SceneFlowSegmentation::bridged(const StereoMatches& stereo, MeasuredFrame measured,
                                                                    const PredictedMotion& predicted) const {
  if (odometry_.trail().empty() || !tracks_.featuresOfLast()) return measured;
  const Features& now = *stereo.features;
  const std::vector<RestingPoint> points = tracks_.seenLast();
  GapBridge::Gap gap{.points = points,
                     .then = *tracks_.featuresOfLast(),
                     .now = now,
                     .disparity_offset_px = disparity_offset_.offset_px(),
                     .duration_s = predicted.dt_s,
                     .ahead_frames = predicted.ahead_frames,
                     .R_cam_level = predicted.R_cam_level};
  std::optional<SE3> T_then_now;
  if (isSure(measured.camera)) T_then_now = measured.camera.T_seen_now;
  // A clock that was set back tells no length of a gap.
  const bool is_gap = predicted.dt_s > 0 && predicted.dt_s < GapBridge::kMaxGap_s;
  if (!T_then_now && is_gap) T_then_now = gap_bridge_.locate(gap, predicted.T_seen_now);
  if (T_then_now && !odometry_.believes(*T_then_now, predicted)) T_then_now.reset();
  if (T_then_now) {
    const std::vector<RestingPoint> lost = without(measured.flow, points);
    gap.points = lost;
    measured = measure(stereo, merged(measured.flow, gap_bridge_.find(gap, *T_then_now)),
                       {*T_then_now, predicted.dt_s, 0, predicted.ahead_frames, predicted.R_cam_level});
  }
  CameraMotion& camera = measured.camera;
  if (T_then_now && camera.status == FrameStatus::kGood && agree(camera.T_seen_now, *T_then_now)) {
    camera.cause = FrameCause::kAfterGap;
  } else {
    camera = odometry_.measure(*now.frame, {}, {}, predicted);
    camera.inliers.assign(measured.of_world.size(), false);
  }
  return measured;
}

SceneMotionPtr SceneFlowSegmentation::passOver(const StereoFrame& unseen) {
  FrameHead head = unseen.head;
  if (!unseen.rejected()) head.status = FrameStatus::kLost, head.cause = FrameCause::kNothingFound;
  return newMotion(head, odometry_.passOver(head.stamp));
}

/// Reuses the buffers of a SceneMotion that nobody holds any more.
std::shared_ptr<SceneMotion> SceneFlowSegmentation::newMotion(const FrameHead& head, const Odometry& odometry) {
  auto motion = motions_.acquire();
  auto points = std::move(motion->points);
  points.clear();
  *motion = SceneMotion{.head = head,
                        .odometry = odometry,
                        .camera_speed_mps = odometry_.speed_mps(),
                        .ground = {},
                        .points = std::move(points),
                        .components = {},
                        .features = {},
                        .own_vehicle = own_vehicle_.view(),
                        .vehicle_sensors = odometry_.vehicleSensors()};
  motion->head.segment = odometry_.segment();
  return motion;
}

ExpectedDisparities SceneFlowSegmentation::expectDisparities(const std::vector<std::optional<KnownPoint>>& known,
                                                             Timestamp stamp, const SE3& T_seen_now) const {
  const SE3 T_now_seen = T_seen_now.inverse();
  ExpectedDisparities expected{.of_point = std::vector<std::optional<ExpectedDisparity>>(known.size()),
                               .motion_known = odometry_.motionKnown(stamp),
                               .offset_px = disparity_offset_.offset_px()};
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!known[i]) continue;
    const double before_px = known[i]->disparity_px;
    const auto at_rest = camera_.project(T_now_seen * known[i]->p_cam);
    expected.of_point[i] = {.before_px = before_px, .at_rest_px = at_rest ? at_rest->z() : before_px};
  }
  return expected;
}

void SceneFlowSegmentation::addPoints(const Observations& of_world, const std::vector<bool>& inliers,
                                      std::vector<ScenePoint>& points) const {
  points.reserve(of_world.size());
  std::size_t next = 0;
  for (const PointTrack& track : tracks_.observedNow()) {
    while (!of_world[next]) ++next;
    const std::size_t i = next++;
    ScenePoint& point = points.emplace_back();  // filled in its place: it is large
    point.point = track.point;
    point.uvd_px = track.newest().uvd_px.cast<double>();
    point.sigma_px = track.newest().sigma_px.cast<double>();
    point.age = track.count;
    point.ambiguous = track.ambiguity > 0;
    point.ego_inlier = inliers[i];
    point.flow = track.flow;
  }
}

/// Tells of each point of the scene whether it breaks the geometry of a static world.
std::vector<bool> SceneFlowSegmentation::testGeometry() const {
  std::vector<bool> violates;
  for (const PointTrack& track : tracks_.observedNow())
    violates.push_back(violatesGeometry(camera_, track, odometry_.trail()));
  return violates;
}

/// Finds the road under the points that may be at rest, and labels those on it. Feet and wheels are near the plane,
/// too.
GroundPlane SceneFlowSegmentation::findGround(const std::vector<bool>& violates_geometry, SceneMotion& motion) {
  std::vector<ScenePoint>& points = motion.points;
  std::vector<GroundCandidate> candidates;
  std::vector<std::size_t> of_candidate;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& flow = points[i].flow;
    if (violates_geometry[i] || (flow && movesSurely(camera_, *flow, motion.camera_speed_mps))) continue;
    candidates.push_back({camera_.triangulate(points[i].uvd_px), points[i].sigma_px.z() / points[i].uvd_px.z()});
    of_candidate.push_back(i);
  }
  GroundPlane ground = ground_plane_(candidates, static_cast<std::uint64_t>(motion.head.frame.value));
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if (ground_plane_.isOnGround(candidates[k])) points[of_candidate[k]].label = PointLabel::kGround;
  return ground;
}

/// Learns from points at rest that were seen at both ends of a window. The remembered disparities follow the offset in
/// use.
void SceneFlowSegmentation::calibrateDisparity() {
  const CameraTrail& trail = odometry_.trail();
  const auto start = disparity_offset_.windowStart(trail.newest().step);
  if (const auto* relation = start ? trail.find(*start) : nullptr)
    disparity_offset_.learn(tracks_.atRestSince(*start), relation->T_then_now.inverse());
  const double change_px = disparity_offset_.advance();
  tracks_.shiftDisparities(static_cast<float>(change_px));
  own_vehicle_.shiftDisparities(change_px);
}

}  // namespace motorcade
