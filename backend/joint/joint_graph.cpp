#include "backend/joint/joint_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "backend/smoother/factors.hpp"

namespace motorcade {
namespace {

constexpr double kFreeMotion = 1e6;     // times the accelerations' variance: nothing is known of how objects move
constexpr double kComparedShare = 0.5;  // objects turn little: a factor is seldom off by the turns of several poses
constexpr int kKeptEliminations = 10;   // of update matrices: those of older poses are hardly ever asked for
constexpr int kEarlierViews = 3;        // of a point whose body is found: one that took longer may be of two
static_assert(kEarlierViews < UndecidedPoints::kMostViews);

IncrementalSolver::Params solverParams(const JointParams& params) {
  return {.policy = IncrementalSolver::Policy::kFluid,
          .batch_every_updates = 50,
          .relinearization = {.mismatch_tolerance = params.mismatch_tolerance,
                              .compared_share = kComparedShare,
                              .jacobian_drift_sigmas = params.jacobian_drift_sigmas,
                              .leisurely_rad = 0.01,  // the budget is the limit
                              .urgent_flops = std::numeric_limits<double>::infinity(),
                              .polish_flops = std::numeric_limits<double>::infinity()},
          .substitution_tolerance = params.substitution_tolerance,
          .spread_scalars = params.spread_scalars,
          .iterations_per_update = params.iterations_per_update,
          .iterated_scalars = 0,
          .budget = {.scalars = params.budget_scalars > 0 ? params.budget_scalars : params.relinearized_scalars,
                     .ms = params.budget_ms},
          .kept_eliminations = kKeptEliminations};
}

Vector6d sigmas(double sigma_m, double tilt_rad, double yaw_rad) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), tilt_rad, tilt_rad, yaw_rad;
  return sigma;
}

bool concernsVariable(SolverProblem::Kind kind) {
  using Kind = SolverProblem::Kind;
  return kind != Kind::kNotFinite && kind != Kind::kUnknownVariable && kind != Kind::kRepeatedVariable;
}

BodyPoints::Params pointParams(const JointParams& params, const StereoCamera& camera, int max_views,
                               int max_landmarks) {
  return {.max_views = max_views,
          .max_landmarks = max_landmarks,
          .half = params.point_half,
          .image_width_px = camera.width_px,
          .image_height_px = camera.height_px};
}

}  // namespace

JointGraph::JointGraph(const JointParams& params, const StereoCamera& camera)
    : params_(params),
      camera_(camera),
      solver_(solverParams(params)),
      world_{.points = BodyPoints(pointParams(params, camera, params.track_frames, params.max_static_landmarks)),
             .noise = {}} {
  const SmallVector zero = SmallVector::Zero(1);
  offset_ = solver_.addVariable(zero);
  holdOffset();
}

/// The camera first: objects are predicted, and their motion is told from the camera's, by where it was then found.
/// Models are corrected with the objects: theirs of the frame before are replaced in between.
void JointGraph::add(const FrameMeasurements& measurements) {
  problems_.clear();
  ++added_frames_;
  addCamera(measurements);
  addPointsAtRest();
  const bool alone = objects_.empty() && measurements.objects.empty();
  dropTroubled(solver_.update(alone ? IncrementalSolver::Correction::kNow : IncrementalSolver::Correction::kLater));
  addObjects(measurements);
  if (showsPoints(measurements)) undecided_.observe(measurements.frame, measurements.undecided);
  calibrate();
}

void JointGraph::addObjects(const FrameMeasurements& measurements) {
  for (const ObjectObservation& seen : measurements.objects)
    if (frames_.contains(seen.frame) && isFinite(seen.T_cam_body)) addObservation(seen);
  if (objects_.empty()) return;
  for (auto& [id, object] : objects_) {
    const bool seen_now = object.records.rbegin()->first == measurements.frame;
    if (!seen_now && showsPoints(measurements)) object.points.points.observe(measurements.frame, {});  // its tracks end
    settleMotion(object, measurements.frame);
    addPoints(object.points, &object);
  }
  dropTroubled(solver_.update());
}

JointObject& JointGraph::objectOf(TrackId id) {
  const auto it = objects_.find(id);
  if (it != objects_.end()) return it->second;
  const BodyPoints::Params points =
      pointParams(params_, camera_, params_.object_track_frames, params_.max_object_landmarks);
  return objects_
      .emplace(id,
               JointObject{.travel = {}, .records = {}, .points = {BodyPoints(points), NoiseLevel::like(world_.noise)}})
      .first->second;
}

void JointGraph::addObservation(const ObjectObservation& seen) {
  JointObject& object = objectOf(seen.track);
  if (object.records.contains(seen.frame)) return;
  const auto last = object.records.empty() ? object.records.end() : std::prev(object.records.end());
  const JointRecord* before = last != object.records.end() && last->second.c.valid() ? &last->second : nullptr;
  JointRecord& record = object.records[seen.frame];
  record.seen = seen;
  record.seen.measured.clear();
  record.seen.measured.shrink_to_fit();  // records are kept for as long as the window
  record.stamp = frames_.at(seen.frame).stamp;
  if (before)
    continueObject(object, *before, record);
  else if (seen.state == ObjectState::kPredicted)
    return;  // nothing to predict from
  else
    beginObject(object, record);
  object.points.points.observe(seen.frame, seen.measured,
                               [&](PointId point) { return undecided_.take(point, seen.frame, kEarlierViews); });
}

void JointGraph::beginObject(JointObject& object, JointRecord& record) {
  const SE3& T_cam_body = record.seen.T_cam_body;
  record.c = solver_.addVariable(T_cam_body);
  Vector6d twist = Vector6d::Zero();
  twist.head<3>() = T_cam_body.rotation().transpose() * record.seen.velocity_cam_mps;
  record.w = solver_.addVariable(SmallVector(twist));
  addPrior(record.c, T_cam_body,
           sigmas(params_.object_origin_sigma_m, params_.object_axes_sigma_rad, params_.object_axes_sigma_rad));
  addPrior(record.w, twist,
           sigmas(params_.twist_sigma_mps, params_.tilt_rate_sigma_radps, params_.yaw_rate_sigma_radps));
  object.travel = solver_.addVariable(SmallVector(SmallVector::Zero(3)));
  addPrior(object.travel, SmallVector::Zero(3),
           Eigen::Vector3d(params_.lever_sigma_m, params_.travel_yaw_sigma_rad, params_.travel_pitch_sigma_rad));
  if (params_.use_smoothness)
    solver_.addFactor(std::make_unique<RollingFactor>(record.w, object.travel, params_.rolling));
}

void JointGraph::continueObject(JointObject& object, const JointRecord& before, JointRecord& record) {
  const double dt_s = secondsBetween(before.stamp, record.stamp);
  const SmallVector twist = std::get<SmallVector>(solver_.estimate(before.w));
  const Vector6d step = dt_s * twist;
  const SE3 u = cameraMotion(before, record);
  record.c = solver_.addVariable((u.inverse() * solver_.pose(before.c) * SE3::exp(step)).normalized());
  record.w = solver_.addVariable(twist);
  addMotion(object, before, record);
  if (params_.use_smoothness)
    solver_.addFactor(std::make_unique<RollingFactor>(record.w, object.travel, params_.rolling));
}

SE3 JointGraph::cameraMotion(const JointRecord& before, const JointRecord& now) const {
  return solver_.pose(frames_.at(before.seen.frame).x).inverse() * solver_.pose(frames_.at(now.seen.frame).x);
}

/// Where the points at rest tell how the camera moved, they tell it a thousand times as well as an object could, whose
/// acceleration is unknown: the camera's motion enters as known, and objects remain independent of each other.
void JointGraph::addMotion(const JointObject& object, const JointRecord& before, JointRecord& now) {
  ConstantTwistFactor::Variables variables{
      .c_a = before.c, .w_a = before.w, .c_b = now.c, .w_b = now.w, .x_a = {}, .x_b = {}};
  const JointCamera &camera_before = frames_.at(before.seen.frame), &camera = frames_.at(now.seen.frame);
  if (camera_before.weak || camera.weak) variables.x_a = camera_before.x, variables.x_b = camera.x;
  const Vector6d density = (params_.use_smoothness ? 1.0 : kFreeMotion) * params_.acceleration.density();
  now.motion = solver_.addFactor(std::make_unique<ConstantTwistFactor>(
      variables, cameraMotion(before, now), secondsBetween(before.stamp, now.stamp), density, travelAxes(object)));
}

/// The camera's motion is known better when its window has passed: an object's motion then is told from it anew.
void JointGraph::settleMotion(JointObject& object, FrameId newest) {
  const auto now = object.records.find(FrameId{newest.value - params_.track_frames});
  if (now == object.records.end() || now == object.records.begin() || !now->second.motion) return;
  const JointRecord& before = std::prev(now)->second;
  if (!before.c.valid() || !now->second.c.valid() || !frames_.contains(before.seen.frame)) return;
  solver_.removeFactor(*now->second.motion);
  addMotion(object, before, now->second);
}

std::optional<FactorId> JointGraph::addGaugePrior(VariableId x, const SE3& mean) {
  return addPrior(x, mean,
                  sigmas(params_.first_pose_sigma_m, params_.first_pose_sigma_rad, params_.first_pose_sigma_rad));
}

std::optional<FactorId> JointGraph::addPrior(VariableId v, const SE3& mean, const Vector6d& sigma) {
  const PoseNoise noise{.sqrt_information = sigma.cwiseInverse().asDiagonal()};
  return solver_.addFactor(std::make_unique<PriorFactor>(std::array{v}, PriorModel{mean}, noise));
}

void JointGraph::addPrior(VariableId v, const SmallVector& mean, const SmallVector& sigma) {
  solver_.addFactor(std::make_unique<VectorPriorFactor>(v, mean, sigma));
}

Eigen::Matrix3d JointGraph::travelAxes(const JointObject& object) const {
  return motorcade::travelAxes(std::get<SmallVector>(solver_.estimate(object.travel)));
}

SE3 JointGraph::objectPose(const JointObject& object, FrameId frame) const {
  const JointRecord& record = object.records.at(frame);
  if (record.frozen) return *record.frozen;
  const SE3 T_cam_body = record.c.valid() ? solver_.pose(record.c) * SE3(travelAxes(object), Eigen::Vector3d::Zero())
                                          : record.seen.T_cam_body;
  return (solver_.pose(frames_.at(frame).x) * T_cam_body).normalized();
}

Eigen::Vector3d JointGraph::objectVelocity_mps(const JointObject& object, FrameId frame) const {
  const JointRecord& record = object.records.at(frame);
  if (!record.w.valid()) return solver_.pose(frames_.at(frame).x).rotation() * record.seen.velocity_cam_mps;
  const Eigen::Matrix3d R_world_cam = solver_.pose(frames_.at(frame).x).rotation();
  const SmallVector twist = std::get<SmallVector>(solver_.estimate(record.w));
  return R_world_cam * solver_.pose(record.c).rotation() * twist.head<3>();
}

double JointGraph::yawRate_radps(const JointObject& object, FrameId frame) const {
  const JointRecord& record = object.records.at(frame);
  if (!record.w.valid()) return 0;
  const SmallVector twist = std::get<SmallVector>(solver_.estimate(record.w));
  return travelAxes(object).col(2).dot(twist.tail<3>());
}

std::vector<VariableId> JointGraph::variablesOf(const JointObject& object) const {
  std::vector<VariableId> variables;
  if (object.travel.valid()) variables.push_back(object.travel);
  for (const auto& [frame, record] : object.records)
    if (record.c.valid()) variables.insert(variables.end(), {record.c, record.w});
  return variables;
}

std::optional<TrackId> JointGraph::objectOf(VariableId v) const {
  for (const auto& [id, object] : objects_)
    if (std::ranges::count(variablesOf(object), v) > 0) return id;
  return std::nullopt;
}

std::string JointGraph::nameOf(VariableId v) const {
  if (v == offset_) return "disparity offset";
  for (const auto& [frame, camera] : frames_)
    if (camera.x == v) return "camera pose of frame " + std::to_string(frame.value);
  for (const auto& [id, object] : objects_) {
    if (object.travel == v) return "travel of object " + std::to_string(id.value);
    for (const auto& [frame, record] : object.records) {
      const std::string of = " of object " + std::to_string(id.value) + " in frame " + std::to_string(frame.value);
      if (record.c == v) return "pose" + of;
      if (record.w == v) return "twist" + of;
    }
  }
  return "a variable that is gone";
}

void JointGraph::dropTroubled(const IncrementalSolver::Report& report) {
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
      JointObject& object = objects_.at(id);
      if (!object.travel.valid()) continue;  // dropped just now
      const auto& after = solver_.drop(variablesOf(object));
      found.insert(found.end(), after.problems.begin(), after.problems.end());
      object.travel = {};
      object.points.current.reset();
      object.points.closed.clear();
      for (auto& [frame, record] : object.records) record.c = record.w = {}, record.motion.reset();
    }
  }
}

void JointGraph::retireOldest() {
  const auto [oldest, camera] = *frames_.begin();
  start_ = {};
  std::vector<VariableId> retired{camera.x};
  for (auto it = objects_.begin(); it != objects_.end();) {
    JointObject& object = it->second;
    object.records.erase(object.records.begin(), object.records.lower_bound(oldest));
    const auto record = object.records.find(oldest);
    if (record != object.records.end()) {
      record->second.frozen = objectPose(object, oldest);
      if (record->second.c.valid()) retired.insert(retired.end(), {record->second.c, record->second.w});
      record->second.c = record->second.w = {};
      if (const auto next = std::next(record); next != object.records.end()) next->second.motion.reset();
    }
    const bool over = object.records.empty() || object.records.rbegin()->first <= oldest;
    if (over && object.travel.valid()) retired.push_back(object.travel);
    it = over ? objects_.erase(it) : std::next(it);
  }
  forgetClosed([oldest = oldest](const ClosedTracks& closed) { return closed.first <= oldest; });
  solver_.retire(retired);
  frames_.erase(frames_.begin());
}

void JointGraph::keep(FrameId frame, const JointCovariances& covariances) {
  if (covariances.camera) frames_.at(frame).covariance = covariances.camera;
  for (const JointCovariances::Object& object : covariances.objects) {
    JointRecord& record = objects_.at(object.track).records.at(frame);
    record.covariance = object.T_cam_body;
    record.velocity_cam_covariance = object.velocity_cam;
    record.speed_sigma_mps = object.speed_sigma_mps;
    record.yaw_rate_sigma_radps = object.yaw_rate_sigma_radps;
  }
}

void JointGraph::converge() {
  constexpr double kConverged = 1e-6;  // m or rad: far below what is published
  problems_.clear();
  if (!alignments_.empty()) {
    eliminateAtRest();
    dropTroubled(solver_.update());
  }
  dropTroubled(solver_.converge(params_.final_iterations, kConverged));
}

}  // namespace motorcade
