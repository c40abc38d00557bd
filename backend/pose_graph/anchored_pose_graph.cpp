#include "backend/pose_graph/anchored_pose_graph.hpp"

#include <algorithm>
#include <array>

#include "backend/pose_graph/object_pairs.hpp"
#include "core/se3.hpp"
#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

IncrementalSolver::Params solverParams(const PoseGraphParams& params, const WindowParams& window) {
  IncrementalSolver::Params solver = windowSolverParams(window);
  if (params.policy == RelinearizationPolicy::kEveryN) solver.policy = IncrementalSolver::Policy::kEveryN;
  solver.batch_every_updates = params.relinearize_every_updates;
  solver.relinearization.mismatch_tolerance = params.mismatch_tolerance;
  solver.relinearization.jacobian_drift_sigmas = params.jacobian_drift_sigmas;
  solver.substitution_tolerance = params.substitution_tolerance;
  solver.iterations_per_update = params.iterations_per_update;
  return solver;
}

}  // namespace

AnchoredPoseGraph::AnchoredPoseGraph(const PoseGraphParams& params, const WindowParams& window)
    : SmoothingWindow(solverParams(params, window), "anchor"),
      params_(requireValid(params)),
      use_smoothness_(window.use_smoothness) {}

void AnchoredPoseGraph::add(const FrameMeasurements& measurements) {
  problems_.clear();
  addCamera(measurements);
  addObjects(measurements);
  dropTroubled(solver_.update());
}

void AnchoredPoseGraph::addObjects(const FrameMeasurements& measurements) {
  std::vector<const ObjectObservation*> seen_now;
  for (const ObjectObservation& seen : measurements.objects)
    if (seen.frame == measurements.head.frame && seen.state != ObjectState::kPredicted && isFinite(seen.T_cam_body))
      seen_now.push_back(&seen);
  std::vector<ObjectPair> pairs;
  if (params_.use_object_encounter && params_.use_camera_encounter)
    pairs = nearestPairs(seen_now, params_.object_encounter_distance_m, params_.object_encounter_partners);
  std::map<TrackId, int> partners;
  for (const auto& [m, n] : pairs) ++partners[seen_now[m]->track], ++partners[seen_now[n]->track];

  for (const ObjectObservation& seen : measurements.objects) {
    if (!frames_.contains(seen.frame)) continue;
    if (!isFinite(seen.T_cam_body)) {
      leftOut(seen, "its pose, which is not finite,");
      continue;
    }
    const bool shares = seen.frame == measurements.head.frame && partners.contains(seen.track);
    addObservation(seen, shares ? 1.0 - params_.object_encounter_share : 1.0);
  }
  for (const auto& [m, n] : pairs) {
    const auto share = [&](std::size_t i) { return params_.object_encounter_share / partners[seen_now[i]->track]; };
    addObjectEncounter(*seen_now[m], *seen_now[n], share(m), share(n));
  }
}

void AnchoredPoseGraph::addPrior(VariableId v, const SE3& mean, double sigma_m, double sigma_rad) {
  solver_.addFactor(priorFactor(v, mean, poseSigmas(sigma_m, sigma_rad, sigma_rad)));
}

void AnchoredPoseGraph::addCamera(const FrameMeasurements& measurements) {
  CameraRecord record{.head = measurements.head, .x = {}, .part = 0, .weak = false, .covariances = {}};
  if (frames_.empty()) {
    record.x = solver_.addVariable(SE3{});
    addPrior(record.x, SE3{}, params_.first_pose_sigma_m, params_.first_pose_sigma_rad);
  } else {
    const VariableId before = frames_.rbegin()->second.x;
    const SE3 T_previous_now =
        isFinite(measurements.odometry.T_previous_now) ? measurements.odometry.T_previous_now : SE3{};
    record.x = solver_.addVariable(solver_.pose(before) * T_previous_now);
    const auto root = squareRootInformation(measurements.odometry.covariance);
    PoseNoise noise = independentNoise(poseSigmas(kUnknownMotion_m, kUnknownMotion_rad, kUnknownMotion_rad));
    if (root && isFinite(measurements.odometry.T_previous_now))
      noise.sqrt_information = *root;
    else
      problems_.push_back("the camera's motion or its covariance is unusable: taken as " +
                          std::string(isFinite(measurements.odometry.T_previous_now) ? "measured" : "standing still") +
                          ", and next to unknown");
    solver_.addFactor(std::make_unique<MotionFactor>(std::array{before, record.x}, MotionModel{T_previous_now}, noise));
  }
  frames_.emplace(measurements.head.frame, record);
}

void AnchoredPoseGraph::startTrack(ObjectTrack& track, const SE3& T_world_body) {
  track.shared = solver_.addVariable(T_world_body);
  addPrior(track.shared, T_world_body, params_.anchor_sigma_m, params_.anchor_sigma_rad);
}

/// Expected pose of the object in its own graph: from its motion if measured, else from the camera's view of it.
SE3 AnchoredPoseGraph::predictedPose(const ObjectTrack& track, const ObjectObservation& seen) const {
  if (seen.motion && params_.use_motion && isFinite(seen.motion->T_before_now)) {
    const auto before = track.records.find(seen.motion->since);
    if (before != track.records.end() && before->second.pose.valid())
      return solver_.pose(before->second.pose) * seen.motion->T_before_now;
  }
  return solver_.pose(track.shared).inverse() * solver_.pose(frames_.at(seen.frame).x) * seen.T_cam_body;
}

void AnchoredPoseGraph::addObservation(const ObjectObservation& seen, double encounter_share) {
  ObjectTrack& track = tracks_[seen.track];
  if (track.records.contains(seen.frame)) return;
  ObjectRecord& record = addRecord(track, seen);
  const bool predicted = seen.state == ObjectState::kPredicted;
  if (!track.shared.valid()) {
    if (predicted) return;  // nothing to predict from
    startTrack(track, solver_.pose(frames_.at(seen.frame).x) * seen.T_cam_body);
    record.pose = solver_.addVariable(SE3{});
    addPrior(record.pose, SE3{}, params_.object_origin_sigma_m, params_.object_origin_sigma_rad);
    if (params_.use_camera_encounter) addCameraEncounter(track, record, encounter_share);
    return;
  }
  if (predicted && !use_smoothness_) return;
  record.pose = solver_.addVariable(predictedPose(track, seen));
  if (!constrain(track, record, encounter_share))
    addPrior(record.pose, solver_.pose(record.pose), params_.anchor_sigma_m, params_.anchor_sigma_rad);
}

/// Constrains a pose; false when there is nothing to constrain it with.
bool AnchoredPoseGraph::constrain(const ObjectTrack& track, const ObjectRecord& record, double encounter_share) {
  bool constrained = false;
  if (record.seen.state != ObjectState::kPredicted) {
    if (params_.use_motion) constrained |= addMotion(track, record);
    if (params_.use_camera_encounter) constrained |= addCameraEncounter(track, record, encounter_share);
  }
  if (use_smoothness_) constrained |= addSmoothness(track, record.seen.frame);
  return constrained;
}

bool AnchoredPoseGraph::addMotion(const ObjectTrack& track, const ObjectRecord& record) {
  if (!record.seen.motion) return false;
  const auto& motion = *record.seen.motion;
  const auto before = track.records.find(motion.since);
  if (before == track.records.end() || !before->second.pose.valid()) return false;
  const auto root = squareRootInformation(motion.covariance);
  if (!root) {
    leftOut(record.seen, "its motion, whose covariance is not positive definite,");
    return false;
  }
  const PoseNoise noise{
      .sqrt_information = *root, .loss = params_.motion_loss, .loss_scale = params_.motion_loss_scale};
  const std::array variables{before->second.pose, record.pose};
  return solver_.addFactor(std::make_unique<MotionFactor>(variables, MotionModel{motion.T_before_now}, noise))
      .has_value();
}

bool AnchoredPoseGraph::addSmoothness(const ObjectTrack& track, FrameId frame) {
  // The two poses before, as far as they are in the graph.
  std::vector<const ObjectRecord*> last;
  for (auto it = std::make_reverse_iterator(track.records.upper_bound(frame));
       it != track.records.rend() && last.size() < 3; ++it)
    if (it->second.pose.valid()) last.push_back(&it->second);
  if (last.size() < 3) return false;
  const double dt_before_s = secondsBetween(last[2]->stamp, last[1]->stamp),
               dt_after_s = secondsBetween(last[1]->stamp, last[0]->stamp);
  if (!(dt_before_s > 0) || !(dt_after_s > 0)) return false;
  const std::array variables{last[2]->pose, last[1]->pose, last[0]->pose};
  const PoseNoise noise = smoothMotionNoise(params_.acceleration, dt_before_s, dt_after_s);
  return solver_
      .addFactor(std::make_unique<SmoothMotionFactor>(variables, SmoothMotionModel{dt_before_s, dt_after_s}, noise))
      .has_value();
}

bool AnchoredPoseGraph::addCameraEncounter(const ObjectTrack& track, const ObjectRecord& record, double share) {
  const auto root = squareRootInformation(record.seen.encounter_covariance / share);
  if (!root) {
    leftOut(record.seen, "its pose, whose covariance is not positive definite,");
    return false;
  }
  const PoseNoise noise{
      .sqrt_information = *root, .loss = params_.encounter_loss, .loss_scale = params_.encounter_loss_scale};
  const std::array variables{frames_.at(record.seen.frame).x, track.shared, record.pose};
  return solver_
      .addFactor(
          std::make_unique<CameraEncounterFactor>(variables, CameraEncounterModel{record.seen.T_cam_body}, noise))
      .has_value();
}

void AnchoredPoseGraph::addObjectEncounter(const ObjectObservation& m, const ObjectObservation& n, double share_m,
                                           double share_n) {
  const ObjectTrack &track_m = tracks_.at(m.track), &track_n = tracks_.at(n.track);
  const VariableId z_m = track_m.records.at(m.frame).pose, z_n = track_n.records.at(n.frame).pose;
  const RelativePose relative = relativePose(m, n, 1 / share_m, 1 / share_n);
  const auto root = squareRootInformation(relative.covariance);
  if (!root || !z_m.valid() || !z_n.valid()) return;
  const PoseNoise noise{
      .sqrt_information = *root, .loss = params_.encounter_loss, .loss_scale = params_.encounter_loss_scale};
  const std::array variables{track_m.shared, z_m, track_n.shared, z_n};
  solver_.addFactor(std::make_unique<ObjectEncounterFactor>(variables, ObjectEncounterModel{relative.T_m_n}, noise));
}

void AnchoredPoseGraph::leftOut(const ObjectObservation& seen, const std::string& what) {
  problems_.push_back("object " + std::to_string(seen.track.value) + ", frame " + std::to_string(seen.frame.value) +
                      ": " + what + " is left out");
}

void AnchoredPoseGraph::converge() {
  constexpr double kConverged = 1e-7;  // m or rad: far below what is published
  problems_.clear();
  dropTroubled(solver_.converge(params_.final_iterations, kConverged));
}

}  // namespace motorcade
