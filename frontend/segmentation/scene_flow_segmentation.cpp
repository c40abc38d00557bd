#include "frontend/segmentation/scene_flow_segmentation.hpp"

#include <algorithm>
#include <cmath>

#include "frontend/geometry/point_grid.hpp"
#include "frontend/parallel_items.hpp"
#include "frontend/segmentation/geometric_constraints.hpp"

namespace motorcade {

SceneFlowSegmentation::SceneFlowSegmentation(const Params& params, const StereoCamera& camera)
    : params_(requireValid(params)),
      camera_(camera),
      disparity_offset_(params.disparity_offset, camera),
      ego_motion_(params.ego_motion, camera),
      scene_flow_(params.scene_flow, camera),
      ground_plane_(params.ground_plane),
      segmenter_(params.segmenter, camera) {}

SE3 SceneFlowSegmentation::predictMotion(Timestamp stamp) const {
  if (!last_motion_ || last_dt_s_ <= 0) return SE3{};
  return scaledMotion(*last_motion_, secondsBetween(trail_.newest().stamp, stamp) / last_dt_s_);
}

/// In the memory of one that is no longer in use.
std::shared_ptr<SceneMotion> SceneFlowSegmentation::emptyMotion() {
  auto motion = motions_.acquire();
  auto points = std::move(motion->points);
  points.clear();
  *motion = SceneMotion{};
  motion->points = std::move(points);
  return motion;
}

SceneMotionPtr SceneFlowSegmentation::operator()(const StereoMatchesPtr& stereo, const OpticalFlowPtr& flow) {
  const StereoFrame& frame = *stereo->features->frame;
  auto motion = emptyMotion();
  motion->frame = frame.frame;
  motion->stamp = frame.stamp;
  const SE3 predicted = trail_.empty() ? SE3{} : predictMotion(frame.stamp);
  const auto sighted = frame.rejected() ? std::vector<Sighted>{} : closeCircle(*stereo, *flow, predicted);

  std::vector<bool> inliers(sighted.size(), false);
  if (!trail_.empty()) {
    inliers = estimateEgoMotion(sighted, predicted, *motion);
    last_motion_ = motion->T_previous_now;
    last_dt_s_ = secondsBetween(trail_.newest().stamp, frame.stamp);
  }
  if (frame.rejected()) motion->status = FrameStatus::kRejected;
  trail_.add(frame.stamp, motion->T_previous_now);
  if (frame.rejected()) {
    previous_features_.reset();
    return motion;
  }

  updateTracks(sighted, stereo->features);
  fillPoints(sighted, inliers, *motion);
  std::vector<bool> violates_geometry;
  for (const auto& track : tracks_)
    if (sightedNow(track)) violates_geometry.push_back(violatesGeometry(track));
  markGround(*motion, violates_geometry);
  motion->segments = segmenter_(motion->points, violates_geometry, motion->ground);

  auto point = motion->points.begin();
  for (auto& track : tracks_)
    if (sightedNow(track)) track.label = (point++)->label;
  calibrateDisparity();
  motion->disparity_offset_px = disparity_offset_.offset_px();
  return motion;
}

/// Learns from points at rest that were seen at both ends of a window; the disparities remembered follow the offset in
/// use.
void SceneFlowSegmentation::calibrateDisparity() {
  const std::int64_t now = trail_.newest().step, then = now - params_.disparity_offset.window_frames;
  const auto* relation = trail_.find(then);
  if (relation && now % params_.disparity_offset.window_frames == 0) {
    std::vector<StereoCorrespondence> points;
    for (const auto& track : tracks_) {
      if (!sightedNow(track) || !track.p_static_cam || track.label == PointLabel::kMoving) continue;
      const auto* before = track.find(then);
      if (!before) continue;
      points.push_back({before->uvd_px.cast<double>(), before->sigma_px.cast<double>(),
                        track.newest().uvd_px.cast<double>(), track.newest().sigma_px.cast<double>()});
    }
    disparity_offset_.learn(points, relation->T_then_now.inverse());
  }
  const auto change = static_cast<float>(disparity_offset_.advance());
  for (auto& track : tracks_)
    for (int i = 0; i < track.count; ++i) track.observations[i].uvd_px.z() += change;
}

std::vector<SceneFlowSegmentation::Sighted> SceneFlowSegmentation::closeCircle(
    const StereoMatches& stereo, const OpticalFlow& flow, const SE3& predicted_T_previous_now) const {
  std::vector<Sighted> sighted;
  sighted.reserve(flow.observations.size());
  auto track = tracks_.begin();
  for (const auto& f : flow.observations) {
    while (track != tracks_.end() && track->point < f.point) ++track;
    const bool known = track != tracks_.end() && track->point == f.point;
    sighted.push_back({.flow = f, .track = known ? &*track : nullptr, .disparity = std::nullopt});
  }
  const PointGrid corners(stereo.features->corners, camera_.width_px, camera_.height_px,
                          [](const Corner& c) { return Eigen::Vector2f(c.u_px, c.v_px); });
  const SE3 predicted_T_now_previous = predicted_T_previous_now.inverse();
  forEachItem(sighted.size(), [&](std::size_t i) {
    Sighted& s = sighted[i];
    s.disparity = s.track ? verifyInRightImage(*stereo.features, s.flow, *s.track, predicted_T_now_previous)
                          : firstDisparity(stereo, corners, s.flow);
    if (s.disparity) s.disparity->disparity_px += static_cast<float>(disparity_offset_.offset_px());
    if (s.disparity && !(s.disparity->disparity_px > 0)) s.disparity.reset();
  });
  std::erase_if(sighted, [](const Sighted& s) { return !s.track && !s.disparity; });
  return sighted;
}

/// Stereo matching gives it where the track was born; where it failed there, a matched corner close by tells where to
/// look.
std::optional<StereoMatch> SceneFlowSegmentation::firstDisparity(const StereoMatches& stereo, const PointGrid& corners,
                                                                 const FlowObservation& flow) const {
  if (flow.corner >= 0 && stereo.of_corner[flow.corner]) return stereo.of_corner[flow.corner];
  const Eigen::Vector2f here(flow.u_px, flow.v_px),
      reach = Eigen::Vector2f::Constant(static_cast<float>(params_.neighbor_px));
  std::pair nearest(reach.x(), -1);  // distance and number of a corner; of equal distances the first corner counts
  corners.forEachNear(here - reach, here + reach, [&](int i) {
    if (!stereo.of_corner[i]) return;
    const Corner& c = stereo.features->corners[i];
    const std::pair candidate((Eigen::Vector2f(c.u_px, c.v_px) - here).cwiseAbs().maxCoeff(), i);
    if (candidate < nearest) nearest = candidate;
  });
  if (nearest.second < 0) return std::nullopt;
  const double disparity_px = stereo.of_corner[nearest.second]->disparity_px;
  const ImagePyramid &left = stereo.features->left, &right = stereo.features->right;
  return refineDisparity(left.levels.front(), right.levels.front(), flow.u_px, flow.v_px, disparity_px,
                         params_.disparity);
}

/// The disparity lies between that of a point at rest and that of a point which moves along with the camera; where
/// nothing is found there, it may be a vehicle that comes towards the camera or overtakes it, at up to the camera's own
/// speed.
std::optional<StereoMatch> SceneFlowSegmentation::verifyInRightImage(const Features& features,
                                                                     const FlowObservation& flow,
                                                                     const PointTrack& track,
                                                                     const SE3& predicted_T_now_previous) const {
  const double before_px = track.newest().uvd_px.z();
  const auto at_rest = camera_.project(predicted_T_now_previous * lastPosition(track).p_ref);
  const double at_rest_px = at_rest ? at_rest->z() : before_px;
  const double middle_px = 0.5 * (at_rest_px + before_px) - disparity_offset_.offset_px(),
               change_px = std::abs(at_rest_px - before_px);
  DisparityParams search = params_.disparity;
  if (!last_motion_) search.search_radius_px += params_.unpredicted_search * before_px;
  const auto within = [&](double reach_px) {
    DisparityParams wider = search;
    wider.search_radius_px += reach_px;
    return refineDisparity(features.left.levels.front(), features.right.levels.front(), flow.u_px, flow.v_px, middle_px,
                           wider);
  };
  const auto between = within(0.5 * change_px);
  return between || change_px < search.search_radius_px ? between : within(1.5 * change_px);
}

PoseObservation SceneFlowSegmentation::lastPosition(const PointTrack& track) const {
  const auto& newest = track.newest();
  const SE3 T_last_then = trail_.find(newest.step)->T_then_now.inverse();
  PoseObservation o;
  if (track.p_static_cam) {
    o.p_ref = T_last_then * *track.p_static_cam;
    o.covariance_ref = T_last_then.rotation() * track.static_covariance * T_last_then.rotation().transpose();
    return o;
  }
  const Eigen::Vector3d uvd = newest.uvd_px.cast<double>();
  const Eigen::Matrix3d J = T_last_then.rotation() * camera_.triangulationJacobian(uvd);
  o.p_ref = T_last_then * camera_.triangulate(uvd);
  o.covariance_ref = J * newest.sigma_px.cast<double>().cwiseAbs2().asDiagonal() * J.transpose();
  return o;
}

PoseObservation SceneFlowSegmentation::observe(const Sighted& sighted) const {
  PoseObservation o = lastPosition(*sighted.track);
  o.uvd_px = {sighted.flow.u_px, sighted.flow.v_px, sighted.disparity->disparity_px};
  const double sigma_flow = std::max<double>(sighted.flow.sigma_px, params_.sigma_flow_px);
  o.sigma_px = {sigma_flow, sigma_flow, std::max<double>(sighted.disparity->sigma_px, params_.sigma_disparity_px)};
  return o;
}

std::vector<bool> SceneFlowSegmentation::estimateEgoMotion(const std::vector<Sighted>& sighted, const SE3& predicted,
                                                           SceneMotion& motion) {
  std::vector<PoseObservation> observations;
  std::vector<bool> known_movers;
  std::vector<bool> inliers(sighted.size(), false);
  std::vector<std::size_t> of_observation;
  observations.reserve(sighted.size());
  of_observation.reserve(sighted.size());
  for (std::size_t i = 0; i < sighted.size(); ++i) {
    if (!sighted[i].track || !sighted[i].disparity) continue;
    observations.push_back(observe(sighted[i]));
    known_movers.push_back(sighted[i].track->label == PointLabel::kMoving);
    of_observation.push_back(i);
  }
  const PredictedMotion expected{predicted, secondsBetween(trail_.newest().stamp, motion.stamp), steady_frames_};
  const auto ego = ego_motion_(observations, known_movers, expected, static_cast<std::uint64_t>(motion.frame.value));
  if (!ego) {
    motion.status = FrameStatus::kLost;
    motion.T_previous_now = predicted;
    motion.odometry_covariance.setZero();
    motion.odometry_covariance.diagonal().head<3>().setConstant(params_.lost_sigma_m * params_.lost_sigma_m);
    motion.odometry_covariance.diagonal().tail<3>().setConstant(params_.lost_sigma_rad * params_.lost_sigma_rad);
    return inliers;
  }
  if (last_motion_) steady_frames_ = ego->steady ? steady_frames_ + 1 : 0;
  motion.T_previous_now = ego->T_previous_now;
  motion.odometry_covariance = ego->covariance;
  motion.ego_inliers = ego->inlier_count;
  for (std::size_t k = 0; k < of_observation.size(); ++k) inliers[of_observation[k]] = ego->inliers[k];
  return inliers;
}

void SceneFlowSegmentation::updateTracks(const std::vector<Sighted>& sighted, const FeaturesPtr& features) {
  updated_tracks_.resize(sighted.size());
  const Image& now = features->left.levels.front();
  forEachItem(sighted.size(), [&](std::size_t i) {
    updated_tracks_[i] = sighted[i].disparity ? extendTrack(sighted[i], now) : *sighted[i].track;
  });
  previous_features_ = features;
  const std::int64_t oldest_kept = trail_.newest().step - params_.max_missed_frames;
  std::erase_if(updated_tracks_, [&](const PointTrack& track) { return track.newest().step < oldest_kept; });
  std::swap(tracks_, updated_tracks_);
}

/// Looked for both ways: something else may hide its place at rest in one of the two images.
bool SceneFlowSegmentation::isFoundAtRest(const Sighted& s, const Image& now) const {
  const CameraTrail::Relation* before = s.track ? trail_.find(s.track->newest().step) : nullptr;
  if (!before || !previous_features_ || s.track->newest().step + 1 != trail_.newest().step) return false;
  const Image& image_before = previous_features_->left.levels.front();
  const Eigen::Vector3d uvd_now(s.flow.u_px, s.flow.v_px, s.disparity->disparity_px),
      uvd_before = s.track->newest().uvd_px.cast<double>();
  const auto found = [&](const Eigen::Vector3d& uvd, const Image& image, const SE3& T_other_this,
                         const Eigen::Vector3d& uvd_other, const Image& other) {
    const Eigen::Vector3d p = camera_.triangulate(uvd), p_other = T_other_this * p;
    const auto at_rest = camera_.project(p_other);
    return at_rest && isFoundAtRestToo(image, uvd.head<2>(), other, at_rest->head<2>(), uvd_other.head<2>(),
                                       p.z() / p_other.z(), params_.repeated_texture);
  };
  return found(uvd_now, now, before->T_then_now, uvd_before, image_before) ||
         found(uvd_before, image_before, before->T_then_now.inverse(), uvd_now, now);
}

PointTrack SceneFlowSegmentation::extendTrack(const Sighted& s, const Image& now) const {
  PointTrack track;
  if (s.track) track = *s.track;
  track.point = s.flow.point;
  const auto sigma_flow = std::max(s.flow.sigma_px, static_cast<float>(params_.sigma_flow_px));
  const auto sigma_disparity = std::max(s.disparity->sigma_px, static_cast<float>(params_.sigma_disparity_px));
  track.add({.step = trail_.newest().step,
             .uvd_px = {s.flow.u_px, s.flow.v_px, s.disparity->disparity_px},
             .sigma_px = {sigma_flow, sigma_flow, sigma_disparity}});
  track.p_static_cam.reset();
  track.flow.reset();
  const auto at_rest = scene_flow_.fitStatic(track, trail_);
  const double degrees_of_freedom = std::max(1.0, 3.0 * track.count - 3.0);
  if (at_rest && track.count > 1 && at_rest->chi2 < params_.static_chi2_per_dof * degrees_of_freedom) {
    track.p_static_cam = at_rest->p_cam;
    track.static_covariance = at_rest->covariance;
  }
  track.flow = scene_flow_.fitMoving(track, trail_, at_rest);
  if (track.flow && track.flow->static_chi2 - track.flow->moving_chi2 > params_.repeat_check_chi2)
    track.repeats = std::clamp(track.repeats + (isFoundAtRest(s, now) ? 1 : -1), 0, 3);
  return track;
}

void SceneFlowSegmentation::fillPoints(const std::vector<Sighted>& sighted, const std::vector<bool>& inliers,
                                       SceneMotion& motion) const {
  motion.points.reserve(tracks_.size());
  auto track = tracks_.begin();
  for (std::size_t i = 0; i < sighted.size(); ++i) {
    if (!sighted[i].disparity) continue;
    while (track->point != sighted[i].flow.point) ++track;
    const auto& newest = track->newest();
    motion.points.push_back({.point = track->point,
                             .uvd_px = newest.uvd_px.cast<double>(),
                             .sigma_px = newest.sigma_px.cast<double>(),
                             .age = track->count,
                             .repeats = track->repeats > 0,
                             .ego_inlier = inliers[i],
                             .flow = track->flow});
  }
}

void SceneFlowSegmentation::markGround(SceneMotion& motion, const std::vector<bool>& violates_geometry) {
  std::vector<GroundCandidate> candidates;
  std::vector<double> height_sigma_m(motion.points.size());
  for (std::size_t i = 0; i < motion.points.size(); ++i) {
    const auto& p = motion.points[i];
    const Eigen::Vector3d p_cam = camera_.triangulate(p.uvd_px);
    height_sigma_m[i] = std::abs(p_cam.y()) * p.sigma_px.z() / p.uvd_px.z();
    if (!violates_geometry[i]) candidates.push_back({p_cam, height_sigma_m[i]});
  }
  motion.ground = ground_plane_(candidates, static_cast<std::uint64_t>(motion.frame.value));
  for (std::size_t i = 0; i < motion.points.size(); ++i) {
    auto& p = motion.points[i];
    const double height_m = motion.ground.heightOf_m(camera_.triangulate(p.uvd_px));
    const double tolerance_m = params_.ground_plane.inlier_m + std::min(params_.max_ground_noise_m, height_sigma_m[i]);
    if (std::abs(height_m) < tolerance_m && !violates_geometry[i]) p.label = PointLabel::kGround;
  }
}

bool SceneFlowSegmentation::sightedNow(const PointTrack& track) const {
  return track.newest().step == trail_.newest().step;
}

/// Judged over the longest stretch of the track, where the epipolar line is longest.
bool SceneFlowSegmentation::violatesGeometry(const PointTrack& track) const {
  if (track.count < params_.scene_flow.min_observations) return false;
  const auto& then = track.observations.front();
  const auto* relation = trail_.find(then.step);
  if (!relation) return false;
  const auto& now = track.newest();
  const auto residual =
      geometricResidual(camera_, then.uvd_px.cast<double>(), then.sigma_px.cast<double>(),
                        now.uvd_px.head<2>().cast<double>(), now.sigma_px.x(), relation->T_then_now.inverse());
  return residual && (residual->epipolar_sigmas > params_.segmenter.epipolar_violation_sigmas ||
                      residual->flow_bound_px > params_.segmenter.flow_bound_violation_px);
}

std::vector<Parameter> parametersOf(SceneFlowSegmentation::Params& params) {
  return {numberParameter("sigma_flow_px", params.sigma_flow_px, {0.05, 2},
                          "the floor of what the image noise of your camera does to a followed point"),
          numberParameter("sigma_disparity_px", params.sigma_disparity_px, {0.05, 2}, "the same of a disparity"),
          numberParameter("max_missed_frames", params.max_missed_frames, {0, PointTrack::kCapacity - 2},
                          "higher keeps points that are hidden for some frames")};
}

}  // namespace motorcade
