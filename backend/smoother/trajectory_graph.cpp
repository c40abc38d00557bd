#include "backend/smoother/trajectory_graph.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "backend/smoother/object_pairs.hpp"
#include "core/se3.hpp"
#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

PoseNoise isotropic(double sigma_m, double sigma_rad) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return {.sqrt_information = sigma.cwiseInverse().asDiagonal()};
}

IncrementalSolver::Params solverParams(const SmootherParams& params) {
  return {.policy = params.policy == RelinearizationPolicy::kFluid ? IncrementalSolver::Policy::kFluid
                                                                   : IncrementalSolver::Policy::kEveryN,
          .batch_every_updates = params.relinearize_every_updates,
          // No allowances: a window costs little, and objects that little ties down sway when only part of them is
          // relinearized.
          .relinearization = {.mismatch_tolerance = params.mismatch_tolerance,
                              .jacobian_drift_sigmas = params.jacobian_drift_sigmas,
                              .leisurely_rad = 0.01,  // there is no other limit
                              .urgent_flops = std::numeric_limits<double>::infinity(),
                              .polish_flops = std::numeric_limits<double>::infinity()},
          .substitution_tolerance = params.substitution_tolerance,
          .iterations_per_update = params.iterations_per_update,
          .iterated_scalars = 0,
          .budget = {.scalars = params.budget_scalars, .ms = params.budget_ms}};
}

/// True for a problem of a variable, false for that of a factor that was left out.
bool concernsVariable(SolverProblem::Kind kind) {
  using Kind = SolverProblem::Kind;
  return kind != Kind::kNotFinite && kind != Kind::kUnknownVariable && kind != Kind::kRepeatedVariable;
}

}  // namespace

TrajectoryGraph::TrajectoryGraph(const SmootherParams& params) : params_(params), solver_(solverParams(params)) {}

void TrajectoryGraph::add(const FrameMeasurements& measurements) {
  problems_.clear();
  addCamera(measurements);
  std::vector<const ObjectObservation*> seen_now;
  for (const ObjectObservation& seen : measurements.objects)
    if (seen.frame == measurements.frame && seen.state != ObjectState::kPredicted && isFinite(seen.T_cam_body))
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
    const bool shares = seen.frame == measurements.frame && partners.contains(seen.track);
    addObservation(seen, shares ? 1.0 - params_.object_encounter_share : 1.0);
  }
  for (const auto& [m, n] : pairs) {
    const auto share = [&](std::size_t i) { return params_.object_encounter_share / partners[seen_now[i]->track]; };
    addObjectEncounter(*seen_now[m], *seen_now[n], share(m), share(n));
  }
  dropTroubled(solver_.update());
}

void TrajectoryGraph::addPrior(VariableId v, const SE3& mean, double sigma_m, double sigma_rad) {
  solver_.addFactor(std::make_unique<PriorFactor>(std::array{v}, PriorModel{mean}, isotropic(sigma_m, sigma_rad)));
}

void TrajectoryGraph::addCamera(const FrameMeasurements& measurements) {
  CameraRecord record{.stamp = measurements.stamp, .status = measurements.status, .x = {}, .covariance = {}};
  if (frames_.empty()) {
    record.x = solver_.addVariable(SE3{});
    addPrior(record.x, SE3{}, params_.first_pose_sigma_m, params_.first_pose_sigma_rad);
  } else {
    const VariableId before = frames_.rbegin()->second.x;
    const SE3 T_previous_now = isFinite(measurements.T_previous_now) ? measurements.T_previous_now : SE3{};
    record.x = solver_.addVariable(solver_.pose(before) * T_previous_now);
    const auto root = squareRootInformation(measurements.odometry_covariance);
    PoseNoise noise = isotropic(kUnknownMotion_m, kUnknownMotion_rad);
    if (root && isFinite(measurements.T_previous_now))
      noise.sqrt_information = *root;
    else
      problems_.push_back("the camera's motion or its covariance is unusable: taken as " +
                          std::string(isFinite(measurements.T_previous_now) ? "measured" : "standing still") +
                          ", and next to unknown");
    solver_.addFactor(std::make_unique<MotionFactor>(std::array{before, record.x}, MotionModel{T_previous_now}, noise));
  }
  frames_.emplace(measurements.frame, record);
}

void TrajectoryGraph::startTrack(ObjectTrack& track, const SE3& T_world_body) {
  track.anchor = solver_.addVariable(T_world_body);
  addPrior(track.anchor, T_world_body, params_.anchor_sigma_m, params_.anchor_sigma_rad);
}

/// Where the object is expected in its own graph: from its motion if measured, else from where the camera sees it.
SE3 TrajectoryGraph::predictedPose(const ObjectTrack& track, const ObjectObservation& seen) const {
  if (seen.motion && params_.use_motion && isFinite(seen.motion->T_before_now)) {
    const auto before = track.records.find(seen.motion->since);
    if (before != track.records.end() && before->second.z.valid())
      return solver_.pose(before->second.z) * seen.motion->T_before_now;
  }
  return solver_.pose(track.anchor).inverse() * solver_.pose(frames_.at(seen.frame).x) * seen.T_cam_body;
}

void TrajectoryGraph::addObservation(const ObjectObservation& seen, double encounter_share) {
  ObjectTrack& track = tracks_[seen.track];
  if (track.records.contains(seen.frame)) return;
  ObjectRecord& record = track.records[seen.frame];
  record.seen = seen;
  record.stamp = frames_.at(seen.frame).stamp;
  const bool predicted = seen.state == ObjectState::kPredicted;
  if (!track.anchor.valid()) {
    if (predicted) return;  // nothing to predict from
    startTrack(track, solver_.pose(frames_.at(seen.frame).x) * seen.T_cam_body);
    record.z = solver_.addVariable(SE3{});
    addPrior(record.z, SE3{}, params_.object_origin_sigma_m, params_.object_origin_sigma_rad);
    if (params_.use_camera_encounter) addCameraEncounter(track, record, encounter_share);
    return;
  }
  if (predicted && !params_.use_smoothness) return;
  record.z = solver_.addVariable(predictedPose(track, seen));
  if (!constrain(track, record, encounter_share))
    addPrior(record.z, solver_.pose(record.z), params_.anchor_sigma_m, params_.anchor_sigma_rad);
}

/// False when there is nothing to constrain the pose with.
bool TrajectoryGraph::constrain(const ObjectTrack& track, const ObjectRecord& record, double encounter_share) {
  bool constrained = false;
  if (record.seen.state != ObjectState::kPredicted) {
    if (params_.use_motion) constrained |= addMotion(track, record);
    if (params_.use_camera_encounter) constrained |= addCameraEncounter(track, record, encounter_share);
  }
  if (params_.use_smoothness) constrained |= addSmoothness(track, record.seen.frame);
  return constrained;
}

bool TrajectoryGraph::addMotion(const ObjectTrack& track, const ObjectRecord& record) {
  if (!record.seen.motion) return false;
  const auto& motion = *record.seen.motion;
  const auto before = track.records.find(motion.since);
  if (before == track.records.end() || !before->second.z.valid()) return false;
  const auto root = squareRootInformation(motion.covariance);
  if (!root) {
    leftOut(record.seen, "its motion, whose covariance is not positive definite,");
    return false;
  }
  const PoseNoise noise{
      .sqrt_information = *root, .loss = params_.motion_loss, .loss_scale = params_.motion_loss_scale};
  const std::array variables{before->second.z, record.z};
  return solver_.addFactor(std::make_unique<MotionFactor>(variables, MotionModel{motion.T_before_now}, noise))
      .has_value();
}

bool TrajectoryGraph::addSmoothness(const ObjectTrack& track, FrameId frame) {
  // The two poses before, as far as they are in the graph.
  std::vector<const ObjectRecord*> last;
  for (auto it = std::make_reverse_iterator(track.records.upper_bound(frame));
       it != track.records.rend() && last.size() < 3; ++it)
    if (it->second.z.valid()) last.push_back(&it->second);
  if (last.size() < 3) return false;
  const double dt_before_s = secondsBetween(last[2]->stamp, last[1]->stamp),
               dt_after_s = secondsBetween(last[1]->stamp, last[0]->stamp);
  if (!(dt_before_s > 0) || !(dt_after_s > 0)) return false;
  const std::array variables{last[2]->z, last[1]->z, last[0]->z};
  const PoseNoise noise = smoothMotionNoise(params_.acceleration, dt_before_s, dt_after_s);
  return solver_
      .addFactor(std::make_unique<SmoothMotionFactor>(variables, SmoothMotionModel{dt_before_s, dt_after_s}, noise))
      .has_value();
}

bool TrajectoryGraph::addCameraEncounter(const ObjectTrack& track, const ObjectRecord& record, double share) {
  const auto root = squareRootInformation(record.seen.encounter_covariance / share);
  if (!root) {
    leftOut(record.seen, "its pose, whose covariance is not positive definite,");
    return false;
  }
  const PoseNoise noise{
      .sqrt_information = *root, .loss = params_.encounter_loss, .loss_scale = params_.encounter_loss_scale};
  const std::array variables{frames_.at(record.seen.frame).x, track.anchor, record.z};
  return solver_
      .addFactor(
          std::make_unique<CameraEncounterFactor>(variables, CameraEncounterModel{record.seen.T_cam_body}, noise))
      .has_value();
}

void TrajectoryGraph::addObjectEncounter(const ObjectObservation& m, const ObjectObservation& n, double share_m,
                                         double share_n) {
  const ObjectTrack &track_m = tracks_.at(m.track), &track_n = tracks_.at(n.track);
  const VariableId z_m = track_m.records.at(m.frame).z, z_n = track_n.records.at(n.frame).z;
  const RelativePose relative = relativePose(m, n, 1 / share_m, 1 / share_n);
  const auto root = squareRootInformation(relative.covariance);
  if (!root || !z_m.valid() || !z_n.valid()) return;
  const PoseNoise noise{
      .sqrt_information = *root, .loss = params_.encounter_loss, .loss_scale = params_.encounter_loss_scale};
  const std::array variables{track_m.anchor, z_m, track_n.anchor, z_n};
  solver_.addFactor(std::make_unique<ObjectEncounterFactor>(variables, ObjectEncounterModel{relative.T_m_n}, noise));
}

SE3 TrajectoryGraph::objectPose(const ObjectTrack& track, FrameId frame) const {
  const ObjectRecord& record = track.records.at(frame);
  if (record.frozen) return *record.frozen;
  if (record.z.valid()) return (solver_.pose(track.anchor) * solver_.pose(record.z)).normalized();
  return (solver_.pose(frames_.at(frame).x) * record.seen.T_cam_body).normalized();
}

void TrajectoryGraph::leftOut(const ObjectObservation& seen, const std::string& what) {
  problems_.push_back("object " + std::to_string(seen.track.value) + ", frame " + std::to_string(seen.frame.value) +
                      ": " + what + " is left out");
}

std::vector<VariableId> TrajectoryGraph::variablesOf(const ObjectTrack& track) const {
  std::vector<VariableId> variables;
  if (track.anchor.valid()) variables.push_back(track.anchor);
  for (const auto& [frame, record] : track.records)
    if (record.z.valid()) variables.push_back(record.z);
  return variables;
}

std::optional<TrackId> TrajectoryGraph::objectOf(VariableId v) const {
  for (const auto& [id, track] : tracks_)
    if (std::ranges::count(variablesOf(track), v) > 0) return id;
  return std::nullopt;
}

std::string TrajectoryGraph::nameOf(VariableId v) const {
  for (const auto& [frame, camera] : frames_)
    if (camera.x == v) return "camera pose of frame " + std::to_string(frame.value);
  for (const auto& [id, track] : tracks_) {
    if (track.anchor == v) return "anchor of object " + std::to_string(id.value);
    for (const auto& [frame, record] : track.records)
      if (record.z == v)
        return "pose of object " + std::to_string(id.value) + " in frame " + std::to_string(frame.value);
  }
  return "a variable that is gone";
}

/// Dropping an object may make another one undetermined, and so goes on until no object has a problem.
void TrajectoryGraph::dropTroubled(const IncrementalSolver::Report& report) {
  std::vector<SolverProblem> found = report.problems;
  while (!found.empty()) {
    std::vector<TrackId> troubled;
    for (const SolverProblem& problem : found) {
      const auto object = concernsVariable(problem.kind) ? objectOf(problem.variable) : std::nullopt;
      if (object) troubled.push_back(*object);
      const std::string text = describe(problem, solver_.graph(), [&](VariableId v) { return nameOf(v); });
      problems_.push_back(object ? "object " + std::to_string(object->value) + " is dropped: " + text : text);
    }
    found.clear();
    for (const TrackId id : troubled) {
      ObjectTrack& track = tracks_.at(id);
      if (!track.anchor.valid()) continue;  // dropped just now
      const auto& after = solver_.drop(variablesOf(track));
      found.insert(found.end(), after.problems.begin(), after.problems.end());
      track.anchor = {};
      for (auto& [frame, record] : track.records) record.z = {};
    }
  }
}

void TrajectoryGraph::retireOldest() {
  const auto [oldest, camera] = *frames_.begin();
  std::vector<VariableId> retired{camera.x};
  for (auto it = tracks_.begin(); it != tracks_.end();) {
    ObjectTrack& track = it->second;
    track.records.erase(track.records.begin(), track.records.lower_bound(oldest));
    const auto record = track.records.find(oldest);
    if (record != track.records.end()) {
      record->second.frozen = objectPose(track, oldest);
      if (record->second.z.valid()) retired.push_back(record->second.z);
      record->second.z = {};
    }
    const bool over = track.records.empty() || track.records.rbegin()->first <= oldest;
    if (over && track.anchor.valid()) retired.push_back(track.anchor);
    it = over ? tracks_.erase(it) : std::next(it);
  }
  solver_.retire(retired);
  frames_.erase(frames_.begin());
}

void TrajectoryGraph::converge() {
  constexpr double kConverged = 1e-7;  // m or rad: far below what is published
  problems_.clear();
  dropTroubled(solver_.converge(params_.final_iterations, kConverged));
}

void TrajectoryGraph::keep(FrameId frame, const FrameCovariances& covariances) {
  if (covariances.camera) frames_.at(frame).covariance = covariances.camera;
  for (const FrameCovariances::Object& object : covariances.objects) {
    ObjectRecord& record = tracks_.at(object.track).records.at(frame);
    record.covariance = object.T_cam_body;
    if (object.speed_sigma_mps) record.speed_sigma_mps = object.speed_sigma_mps;
    if (object.yaw_rate_sigma_radps) record.yaw_rate_sigma_radps = object.yaw_rate_sigma_radps;
  }
}

}  // namespace motorcade
