#include "frontend/tracking/object_tracker.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/decompositions.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/duplicate_objects.hpp"
#include "frontend/tracking/object_association.hpp"
#include "frontend/tracking/region_walkers.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

constexpr int kMaxTentativeMisses = 1;   // frames without a measurement, after which a tentative object ends
constexpr double kMaxLostSigma_m = 3;    // of a position: less well known, what is met there may be another vehicle
constexpr double kOutsideImage_px = 50;  // an unseen object that is predicted this far outside has left
constexpr double kInsideImage_px = 10;   // unless the middle of its points is predicted this far inside
constexpr double kReappearanceSpread_m = 1.0;  // standard deviation of the middle of an object's points when it is seen
                                               // again, about that of those seen last
constexpr int kStopFrames = 3;                 // in a row below the stop speed, as the speed's noise may fall below it

/// Place of an object: the box around its points, with some room beside it.
class Place {
 public:
  explicit Place(const TrackedObject& object)
      : box_(object.extent(kBeside_m)), T_body_cam_(object.T_cam_body.inverse()) {}
  bool holds(const Eigen::Vector3d& p_cam) const { return box_.contains(T_body_cam_ * p_cam); }

 private:
  static constexpr double kBeside_m = 0.4;
  Eigen::AlignedBox3d box_;
  SE3 T_body_cam_;
};

/// True when a point lies on what is known of an object, or hardly beside it.
bool isAt(const TrackedObject& object, const Eigen::Vector3d& p_cam) { return Place(object).holds(p_cam); }

}  // namespace

ObjectTracker::ObjectTracker(const Params& params, const StereoCamera& camera)
    : params_(requireValid(params)),
      camera_(camera),
      adopt_(camera),
      motion_(params.motion, camera),
      spawn_(params.motion, camera),
      is_confirmed_(params.confirmation, camera),
      look_back_(params.look_back_frames, params.confirmation.confirm_observations, params.motion, camera) {}

FrameMeasurementsPtr ObjectTracker::operator()(const SceneMotionPtr& scene) {
  auto measurements = std::make_shared<FrameMeasurements>();
  measurements->head = scene->head;
  measurements->odometry = scene->odometry;
  advance(*scene);
  if (scene->head.cause == FrameCause::kUnlinked && !scene->odometry.told) endAll(*measurements);
  for (TrackedObject& object : objects_) follow(object, *scene, *measurements);
  removeEnded(*measurements);  // they claim no component
  matchComponents(*scene);
  mergeDuplicates(objects_, SeeThrough(*scene, camera_), camera_);
  confirmSure(*scene, *measurements);
  look_back_.remember(scene, T_world_cam_, measurements->objects, objects_);
  handOverPassed(*measurements);
  removeEnded(*measurements);
  measurements->disparity_offset_px = scene->disparity_offset_px;
  measurements->own_vehicle = scene->own_vehicle;
  measurements->vehicle_sensors = scene->vehicle_sensors;
  addOtherPoints(*scene, *measurements);
  std::ranges::stable_sort(measurements->objects, {}, &ObjectObservation::track);
  previous_scene_ = scene;
  return measurements;
}

void ObjectTracker::advance(const SceneMotion& scene) {
  T_world_cam_ = (T_world_cam_ * scene.odometry.T_previous_now).normalized();
  if (!previous_scene_) return;
  const double dt_s = secondsBetween(previous_scene_->head.stamp, scene.head.stamp);
  for (TrackedObject& object : objects_) {
    object.kinematics.predict(dt_s, kinematicsOf(object, params_.kinematics));
    object.T_cam_body = T_world_cam_.inverse() * object.kinematics.pose();
  }
}

/// Ends all objects. Nobody knows where they are now, seen from the camera: what is met may be another vehicle.
void ObjectTracker::endAll(FrameMeasurements& measurements) {
  look_back_.forget();
  for (TrackedObject& object : objects_) object.life.end();
  removeEnded(measurements);
}

void ObjectTracker::follow(TrackedObject& object, const SceneMotion& scene, FrameMeasurements& measurements) {
  disownOtherBodies(object, scene);
  auto observation = motion_.follow(object, scene, T_world_cam_);
  if (!observation) return coast(object, scene, measurements);
  object.life.observe();
  object.kinematics.fuseVehicleModel(upInWorld(scene, T_world_cam_), kinematicsOf(object, params_.kinematics));
  object.T_cam_body = T_world_cam_.inverse() * object.kinematics.pose();
  object.last_middle_body = object.middle();
  updateState(object);
  observation->frame = scene.head.frame;
  observation->state = object.state;
  record(object, std::move(*observation), measurements);
}

/// Passes a frame without a measurement of the object.
void ObjectTracker::coast(TrackedObject& object, const SceneMotion& scene, FrameMeasurements& measurements) {
  object.life.miss();
  if (isOutOfReach(object)) return object.life.end();
  if (object.life.phase() == Phase::kTentative) return;
  if (auto observation = withoutMeasurement(object, scene)) record(object, std::move(*observation), measurements);
}

bool ObjectTracker::isOutOfReach(const TrackedObject& object) const {
  const int allowed = object.life.phase() == Phase::kTentative ? kMaxTentativeMisses : params_.max_lost_frames;
  if (object.life.missed() > allowed || object.kinematics.positionSigma_m() > kMaxLostSigma_m) return true;
  return !mayBeInImage(object);
}

/// True when the body's origin is in the image or just outside, or the middle of its points well inside.
bool ObjectTracker::mayBeInImage(const TrackedObject& object) const {
  return isOriginNearImage(object) || isInImage(object.T_cam_body * object.middle(), kInsideImage_px);
}

bool ObjectTracker::isOriginNearImage(const TrackedObject& object) const {
  return isInImage(object.T_cam_body.translation(), -kOutsideImage_px);
}

bool ObjectTracker::isInImage(const Eigen::Vector3d& p_cam, double margin_px) const {
  const auto uvd = camera_.project(p_cam);
  return uvd && camera_.inLeftImage(uvd->x(), uvd->y(), margin_px);
}

/// Begins a new object, with an id of its own, on the points that are left of one whose origin is out of the image. No
/// vehicle reaches so far from its middle: the points lie on a trailer behind a truck, or on the rear of a body whose
/// origin was at its front.
void ObjectTracker::handOverPassed(FrameMeasurements& measurements) {
  constexpr double kReach_m = 0.5 * kLongestVehicle.length_m;
  for (TrackedObject& object : objects_) {
    const Eigen::Vector3d middle_body = object.middle();
    const bool has_passed = !isOriginNearImage(object) && middle_body.norm() > kReach_m;
    if (object.life.phase() != Phase::kConfirmed || !has_passed) continue;
    measurements.ended.push_back(object.track);
    object.track = spawn_.newTrack();
    object.changeBodyFrame(SE3(Eigen::Matrix3d::Identity(), middle_body));
    object.last_middle_body.setZero();
  }
  std::ranges::sort(objects_, {}, &TrackedObject::track);
}

/// Report of a lost object: its predicted pose, as an observation where there is visible evidence of it. Without
/// evidence it is a prediction, for some frames.
std::optional<ObjectObservation> ObjectTracker::withoutMeasurement(const TrackedObject& object,
                                                                   const SceneMotion& scene) const {
  std::optional<ObjectObservation> observation;
  if (object.kinematics.positionSigma_m() < ObjectMotionEstimator::kMaxEvidenceSigma_m)
    observation =
        motion_.visibleEvidence(object, scene, {object.T_cam_body, inverse(object.kinematics.poseCovariance())});
  if (observation) {
    observation->state = object.state;
  } else if (object.life.missed() <= params_.max_coasted_frames) {
    observation.emplace();
    observation->state = ObjectState::kPredicted;
    observation->T_cam_body = object.T_cam_body;
    observation->encounter_covariance = object.kinematics.poseCovariance();
    if (const auto origin = camera_.project(object.T_cam_body.translation()))
      observation->box = {origin->x(), origin->y(), origin->x(), origin->y()};
  }
  if (observation) observation->frame = scene.head.frame;
  return observation;
}

void ObjectTracker::updateState(TrackedObject& object) const {
  const double speed_mps = object.kinematics.speed_mps();
  object.slow_frames = speed_mps < params_.stop_speed_mps ? object.slow_frames + 1 : 0;
  if (object.slow_frames >= kStopFrames) object.state = ObjectState::kStopped;
  if (speed_mps > params_.start_speed_mps) object.state = ObjectState::kMoving;
}

/// Reports an observation, or keeps it until the object is confirmed.
void ObjectTracker::record(TrackedObject& object, ObjectObservation observation, FrameMeasurements& measurements) {
  observation.track = object.track;
  observation.born_slow = object.born_slow;
  observation.born_labelled = object.born_labelled;
  observation.velocity_cam_mps = T_world_cam_.rotation().transpose() * object.kinematics.velocityWorld_mps();
  if (object.life.reported()) {
    measurements.objects.push_back(std::move(observation));
  } else {
    object.backlog.push_back(std::move(observation));
  }
}

/// Confirms tentative objects that were observed in this frame and are no part of others.
void ObjectTracker::confirmSure(const SceneMotion& scene, FrameMeasurements& measurements) {
  for (TrackedObject& object : objects_) {
    const bool observed = object.life.phase() == Phase::kTentative && object.life.missed() == 0;
    if (observed && is_confirmed_(object, measurements.objects, scene.ground)) confirm(object, measurements);
  }
}

/// Confirms an object and sets its body axes once and for all: x along the travel, the origin amid the points. By now
/// the direction of travel is better known, and points that were not the body's are gone.
void ObjectTracker::confirm(TrackedObject& object, FrameMeasurements& measurements) {
  const Eigen::Matrix3d& R = object.kinematics.pose().rotation();
  const Eigen::Matrix3d R_travel = travelAxes(object.kinematics.velocityWorld_mps(), R.col(2));
  object.changeBodyFrame(SE3(R.transpose() * R_travel, object.middle()));
  object.life.confirm();
  look_back_(object, measurements.head.stamp, params_.kinematics);
  for (ObjectObservation& o : object.backlog) {
    o.track = object.track;
    o.born_slow = object.born_slow;
    o.born_labelled = object.born_labelled;
    measurements.objects.push_back(std::move(o));
  }
  object.backlog.clear();
}

/// Gives the components' points to the objects that they are matched with, and spawns objects from the others.
void ObjectTracker::matchComponents(const SceneMotion& scene) {
  const std::vector<int> object_of = associateObjects(objects_, scene, T_world_cam_, camera_);
  std::vector<bool> taken(scene.points.size(), false);
  for (const TrackedObject& object : objects_)
    for (const BodyPoint& p : object.points)
      if (const ScenePoint* seen = findPoint(scene, p.point); seen && !object.isGuess())
        taken[seen - scene.points.data()] = true;

  for (std::size_t s = 0; s < scene.components.size(); ++s) {
    if (object_of[s] < 0) continue;
    TrackedObject& object = objects_[object_of[s]];
    if (object.life.missed() > 0 && sharedPoints(object, scene, scene.components[s]) == 0)
      reappear(object, scene.components[s]);
    adopt_(object, scene, &scene.components[s], T_world_cam_, taken);
  }
  for (TrackedObject& object : objects_)
    if (object.life.missed() == 0 && !object.isGuess()) adopt_(object, scene, nullptr, T_world_cam_, taken);
  for (std::size_t s = 0; s < scene.components.size(); ++s) {
    if (object_of[s] >= 0 || scene.components[s].label != PointLabel::kMoving) continue;
    std::ranges::move(spawn_(scene, scene.components[s], T_world_cam_, taken), std::back_inserter(objects_));
  }
  spawnWalkers(scene, object_of, taken);
  spawnRegions(scene, taken);
  dropFarthest();
}

/// Spawns people of whom too few points are followed for a moving component.
void ObjectTracker::spawnWalkers(const SceneMotion& scene, const std::vector<int>& object_of,
                                 const std::vector<bool>& taken) {
  if (!previous_scene_ || !previous_scene_->features) return;
  for (std::size_t s = 0; s < scene.components.size(); ++s) {
    const MotionComponent& component = scene.components[s];
    const auto is_taken = [&](int i) { return bool{taken[i]}; };
    const auto holds = [&](const TrackedObject& object) {
      return !object.isGuess() && isAt(object, component.centroid_cam);
    };
    if (object_of[s] >= 0 || !spawn_.mayBeWalker(component, scene.ground)) continue;
    if (std::ranges::any_of(component.points, is_taken) || std::ranges::any_of(objects_, holds)) continue;
    if (auto walker = spawn_.walker(scene, *previous_scene_, component, T_world_cam_))
      objects_.push_back(std::move(*walker));
  }
}

/// Tells of each point whether it lies at an object, even if no object claims it.
std::vector<bool> ObjectTracker::onObjects(const SceneMotion& scene) const {
  std::vector<bool> on_objects(scene.points.size(), false);
  for (const TrackedObject& object : objects_) {
    const Place place(object);
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const Eigen::Vector3d& uvd_px = scene.points[i].uvd_px;
      if (uvd_px.z() > 0 && place.holds(camera_.triangulate(uvd_px))) on_objects[i] = true;
    }
  }
  return on_objects;
}

/// Spawns people who are found as a whole, where instance labels or depth show them.
void ObjectTracker::spawnRegions(const SceneMotion& scene, const std::vector<bool>& taken) {
  if (!scene.features) return;
  const RegionWalkers mover_of(look_back_, camera_);
  for (const RegionWalkers::Candidate& candidate : mover_of.candidates(scene, taken, onObjects(scene), T_world_cam_)) {
    const auto mover = mover_of(candidate, scene, T_world_cam_);
    if (!mover) continue;
    const auto holds = [&](const TrackedObject& object) { return isAt(object, mover->component.centroid_cam); };
    if (std::ranges::any_of(objects_, holds)) continue;
    objects_.push_back(spawn_.region(scene, *mover, T_world_cam_));
  }
}

/// Drops the farthest objects that are not confirmed yet, where more are followed than may be.
void ObjectTracker::dropFarthest() {
  const auto most = static_cast<std::size_t>(params_.max_objects);
  while (objects_.size() > most) {
    const auto importance = [](const TrackedObject& object) {
      return object.life.phase() == Phase::kTentative ? -object.T_cam_body.translation().norm() : 0.0;
    };
    const auto least = std::ranges::min_element(objects_, {}, importance);
    objects_.erase(least);
  }
}

/// Moves an object to where it is seen again, as its position has drifted while it was not seen.
void ObjectTracker::reappear(TrackedObject& object, const MotionComponent& component) const {
  object.kinematics.fusePosition(object.last_middle_body, T_world_cam_ * component.centroid_cam, kReappearanceSpread_m);
  object.T_cam_body = T_world_cam_.inverse() * object.kinematics.pose();
}

/// Adds points that agree with a static world and belong to no object, and those of which more views must tell.
void ObjectTracker::addOtherPoints(const SceneMotion& scene, FrameMeasurements& measurements) const {
  std::vector<PointId> of_objects;
  for (const ObjectObservation& seen : measurements.objects)
    if (seen.frame == scene.head.frame)
      for (const PointMeasurement& p : seen.measured) of_objects.push_back(p.point);
  std::vector<PointId> of_bodies;
  for (const TrackedObject& object : objects_)
    for (const BodyPoint& p : object.points) of_bodies.push_back(p.point);
  std::ranges::sort(of_objects);
  std::ranges::sort(of_bodies);
  for (const ScenePoint& p : scene.points) {
    if (std::ranges::binary_search(of_objects, p.point)) continue;
    const bool rests =
        p.ego_inlier && p.label != PointLabel::kMoving && !std::ranges::binary_search(of_bodies, p.point);
    (rests ? measurements.at_rest : measurements.undecided).push_back(measurementOf(p, scene.disparity_offset_px));
  }
}

void ObjectTracker::removeEnded(FrameMeasurements& measurements) {
  const auto ended = [](const TrackedObject& object) { return object.life.phase() == Phase::kEnded; };
  for (const TrackedObject& object : objects_)
    if (ended(object) && object.life.reported()) measurements.ended.push_back(object.track);
  std::erase_if(objects_, ended);
}

std::vector<Parameter> parametersOf(ObjectTracker::Params& params) {
  std::vector<Parameter> all = parametersOf(params.confirmation);
  const std::vector<Parameter> own{
      numberParameter("look_back_frames", params.look_back_frames, {0, 50},
                      "more fill in an object's path before it was confirmed"),
      numberParameter("max_objects", params.max_objects, {1, 1000},
                      "bounds time and memory in crowds: of new ones the nearest are followed"),
      numberParameter("max_coasted_frames", params.max_coasted_frames, {0, 5},
                      "rows in state `predicted` while an object is not seen"),
      numberParameter("max_lost_frames", params.max_lost_frames, {0, 100},
                      "longer keeps the id of an object that is hidden"),
      numberParameter("stop_speed_mps", params.stop_speed_mps, {0, 0.75},
                      "an object that is slower for some frames is reported as stopped")};
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace motorcade
