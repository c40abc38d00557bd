#include "frontend/tracking/object_tracker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "frontend/segmentation/vehicles_abreast.hpp"

namespace motorcade {
namespace {

/// Body axes for a direction of travel: x ahead over the ground, z up, y to the left.
Eigen::Matrix3d travelAxes(const Eigen::Vector3d& velocity, const Eigen::Vector3d& up) {
  const Eigen::Vector3d ahead = (velocity - up * up.dot(velocity)).normalized();
  Eigen::Matrix3d R;
  R << ahead, up.cross(ahead), up;
  return R;
}

double placeSigma_m(const ObjectKinematics& kinematics) {
  return std::sqrt(kinematics.poseCovariance().topLeftCorner<3, 3>().trace());
}
double placeSigma_m(const TrackedObject& object) { return placeSigma_m(object.kinematics); }

Eigen::Vector3d upInWorld(const SceneMotion& scene, const SE3& T_world_cam) {
  return -(T_world_cam.rotation() * scene.ground.normal_cam);
}

/// Vehicles do not: most points of the one lie within the other.
bool within(const TrackedObject& one, const SE3& T_other_one, const TrackedObject& other) {
  constexpr double kMargin_m = 0.3, kMost = 0.7;  // a margin, as a face alone has no depth
  Eigen::AlignedBox3d box = other.core(SE3{});
  box.min().array() -= kMargin_m;
  box.max().array() += kMargin_m;
  const auto inside =
      std::ranges::count_if(one.points, [&](const BodyPoint& p) { return box.contains(T_other_one * p.p_body); });
  return static_cast<double>(inside) > kMost * static_cast<double>(one.points.size());
}

double diagonal_px(const Box& box) { return std::hypot(box.right_px - box.left_px, box.bottom_px - box.top_px); }

/// A few points that seem to lie behind a vehicle with many, and within its outline, are the vehicle's own with wrong
/// disparities.
bool looksThrough(const ObjectObservation& few, const std::vector<ObjectObservation>& objects) {
  constexpr double kMargin = 0.25, kMaxMargin_px = 30;  // of the outline's width and height
  constexpr int kMany = 3;
  return std::ranges::any_of(objects, [&](const ObjectObservation& o) {
    const double du = std::min(kMaxMargin_px, kMargin * (o.box.right_px - o.box.left_px));
    const double dv = std::min(kMaxMargin_px, kMargin * (o.box.bottom_px - o.box.top_px));
    return o.frame == few.frame && o.points >= kMany * few.points &&
           o.T_cam_body.translation().z() < few.T_cam_body.translation().z() && o.box.left_px - du < few.box.left_px &&
           few.box.right_px < o.box.right_px + du && o.box.top_px - dv < few.box.top_px &&
           few.box.bottom_px < o.box.bottom_px + dv;
  });
}

}  // namespace

ObjectTracker::ObjectTracker(const Params& params, const StereoCamera& camera)
    : params_(requireValid(params)),
      camera_(camera),
      associate_(params.association),
      adopt_(params.adoption, camera),
      motion_(params.motion, camera) {}

FrameMeasurementsPtr ObjectTracker::operator()(const SceneMotionPtr& scene) {
  auto measurements = std::make_shared<FrameMeasurements>();
  measurements->frame = scene->frame;
  measurements->stamp = scene->stamp;
  measurements->status = scene->status;
  measurements->T_previous_now = scene->T_previous_now;
  measurements->odometry_covariance = scene->odometry_covariance;

  advance(*scene);
  for (auto& object : objects_) follow(object, *scene, *measurements);
  associate(*scene);
  mergeTwins();
  bury(*measurements);
  std::stable_sort(measurements->objects.begin(), measurements->objects.end(),
                   [](const ObjectObservation& a, const ObjectObservation& b) { return a.track < b.track; });
  previous_scene_ = scene;
  past_.push_back({scene, T_world_cam_});
  if (static_cast<int>(past_.size()) > params_.look_back_frames + params_.confirm_observations) past_.pop_front();
  return measurements;
}

void ObjectTracker::advance(const SceneMotion& scene) {
  T_world_cam_ = (T_world_cam_ * scene.T_previous_now).normalized();
  if (!previous_scene_) return;
  const double dt_s = secondsBetween(previous_scene_->stamp, scene.stamp);
  for (auto& object : objects_) {
    object.kinematics.predict(dt_s, params_.kinematics);
    object.T_cam_body_before = object.T_cam_body;
    object.T_cam_body = T_world_cam_.inverse() * object.kinematics.pose();
  }
}

void ObjectTracker::follow(TrackedObject& object, const SceneMotion& scene, FrameMeasurements& measurements) {
  auto observation = motion_.follow(object, scene, previous_scene_.get(), T_world_cam_);
  if (!observation) return coast(object, scene, measurements);
  object.kinematics.fuseVehicleModel(upInWorld(scene, T_world_cam_), params_.kinematics);
  object.T_cam_body = T_world_cam_.inverse() * object.kinematics.pose();
  object.coasted = 0;
  object.last_middle = object.middle();
  ++object.observations;
  updateState(object);
  observation->frame = scene.frame;
  observation->state = object.state;
  record(object, std::move(*observation), measurements);
  object.seen_before = scene.frame;
}

void ObjectTracker::record(TrackedObject& object, ObjectObservation observation, FrameMeasurements& measurements) {
  observation.track = object.track;
  observation.velocity_cam_mps = T_world_cam_.rotation().transpose() * object.kinematics.velocityWorld_mps();
  if (object.confirmed) {
    measurements.objects.push_back(std::move(observation));
    return;
  }
  const bool doubtful =
      looksThrough(observation, measurements.objects) || diagonal_px(observation.box) < params_.confirm_extent_px;
  object.backlog.push_back(std::move(observation));
  if (doubtful) return;
  const double traveled_m = (object.kinematics.pose().translation() - object.birthplace_world).norm();
  const double speed = object.kinematics.speed_mps();
  const bool moves =
      speed > params_.confirm_speed_mps && speed > params_.confirm_significance * object.kinematics.speedSigma_mps();
  const bool far_enough = object.observations >= params_.confirm_observations && traveled_m > params_.confirm_travel_m;
  if (far_enough && moves && object.extent(0).diagonal().norm() > params_.confirm_extent_m)
    confirm(object, measurements);
}

/// The direction of travel is known better now than at birth, and points that were not the body's are gone: the body's
/// x axis is laid along the travel and its origin amid the points, once and for all.
void ObjectTracker::confirm(TrackedObject& object, FrameMeasurements& measurements) {
  const Eigen::Matrix3d& R = object.kinematics.pose().rotation();
  const Eigen::Matrix3d R_travel = travelAxes(object.kinematics.velocityWorld_mps(), R.col(2));
  object.changeBodyFrame(SE3(R.transpose() * R_travel, object.middle()));
  object.confirmed = true;
  lookBack(object, measurements.stamp);
  for (auto& o : object.backlog) {
    o.track = object.track;
    measurements.objects.push_back(std::move(o));
  }
  object.backlog.clear();
}

/// The points from which an object is born were followed for some frames before: they tell where it was then.
void ObjectTracker::lookBack(TrackedObject& object, Timestamp now) const {
  auto earlier = past_.rbegin();
  while (earlier != past_.rend() && earlier->scene->frame >= object.backlog.front().frame) ++earlier;
  for (int k = 0; k < params_.look_back_frames && earlier != past_.rend(); ++k, ++earlier) {
    ObjectKinematics then = object.kinematics;
    then.predict(secondsBetween(now, earlier->scene->stamp), params_.kinematics);
    const PosePrior prior{earlier->T_world_cam.inverse() * then.pose(), then.poseCovariance().inverse()};
    auto observation = motion_.lookBack(object, *earlier->scene, prior);
    if (!observation && placeSigma_m(then) < params_.max_presence_sigma_m)
      observation = motion_.presence(object, *earlier->scene, prior);
    if (!observation) return;
    observation->frame = earlier->scene->frame;
    observation->velocity_cam_mps = earlier->T_world_cam.rotation().transpose() * then.velocityWorld_mps();
    object.backlog.insert(object.backlog.begin(), std::move(*observation));
  }
}

void ObjectTracker::coast(TrackedObject& object, const SceneMotion& scene, FrameMeasurements& measurements) {
  ++object.coasted;
  object.seen_before = FrameId{};
  const int allowed = object.confirmed ? params_.max_lost_frames : params_.max_tentative_misses;
  if (object.coasted > allowed || leftView(object) || placeSigma_m(object) > params_.max_lost_sigma_m) {
    object.ended = true;
    return;
  }
  if (!object.confirmed) return;
  if (placeSigma_m(object) < params_.max_presence_sigma_m) {
    if (auto present =
            motion_.presence(object, scene, {object.T_cam_body, object.kinematics.poseCovariance().inverse()})) {
      present->frame = scene.frame;
      present->state = object.state;
      return record(object, std::move(*present), measurements);
    }
  }
  if (object.coasted > params_.max_coasted_frames) return;
  ObjectObservation predicted;
  predicted.frame = scene.frame;
  predicted.state = ObjectState::kPredicted;
  predicted.T_cam_body = object.T_cam_body;
  predicted.encounter_covariance = object.kinematics.poseCovariance();
  if (const auto origin = camera_.project(object.T_cam_body.translation()))
    predicted.box = {origin->x(), origin->y(), origin->x(), origin->y()};
  record(object, std::move(predicted), measurements);
}

/// Where it was lost from sight its place has drifted: what is seen again is taken for what was seen last.
void ObjectTracker::reappear(TrackedObject& object, const Segment& segment) const {
  object.kinematics.fusePlace(object.last_middle, T_world_cam_ * segment.centroid_cam, params_.reappearance_spread_m);
  object.T_cam_body = T_world_cam_.inverse() * object.kinematics.pose();
}

bool ObjectTracker::leftView(const TrackedObject& object) const {
  const auto uvd = camera_.project(object.T_cam_body.translation());
  return !uvd || !camera_.inLeftImage(uvd->x(), uvd->y(), -params_.image_margin_px);
}

void ObjectTracker::updateState(TrackedObject& object) const {
  const double speed = object.kinematics.speed_mps();
  object.slow_frames = speed < params_.stop_speed_mps ? object.slow_frames + 1 : 0;
  if (object.slow_frames >= params_.stop_frames) object.state = ObjectState::kStopped;
  if (speed > params_.start_speed_mps) object.state = ObjectState::kMoving;
}

void ObjectTracker::associate(const SceneMotion& scene) {
  const auto object_of = associate_(objects_, scene, T_world_cam_);
  std::vector<bool> taken(scene.points.size(), false);
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    taken[i] = std::any_of(objects_.begin(), objects_.end(),
                           [&](const auto& o) { return o.find(scene.points[i].point) != nullptr; });

  const std::size_t known = objects_.size();
  for (std::size_t s = 0; s < scene.segments.size(); ++s) {
    if (object_of[s] < 0) continue;
    TrackedObject& object = objects_[object_of[s]];
    if (object.coasted > 0 && sharedPoints(object, scene, scene.segments[s]) == 0) reappear(object, scene.segments[s]);
    adopt_(object, scene, &scene.segments[s], T_world_cam_, taken);
  }
  for (std::size_t m = 0; m < known; ++m)
    if (objects_[m].coasted == 0) adopt_(objects_[m], scene, nullptr, T_world_cam_, taken);
  for (std::size_t s = 0; s < scene.segments.size(); ++s)
    if (object_of[s] < 0 && scene.segments[s].label == PointLabel::kMoving) bear(scene, scene.segments[s], taken);
}

void ObjectTracker::bear(const SceneMotion& scene, const Segment& segment, std::vector<bool>& taken) {
  std::vector<int> free;
  for (const int i : segment.points)
    if (!taken[i]) free.push_back(i);
  for (const Segment& vehicle : splitAbreast(segment, free, scene, params_.adoption.vehicle.width_m))
    if (static_cast<int>(vehicle.points.size()) >= params_.motion.min_points) bearOne(scene, vehicle, taken);
}

void ObjectTracker::bearOne(const SceneMotion& scene, const Segment& segment, std::vector<bool>& taken) {
  TrackedObject object;
  object.track = TrackId{next_track_++};
  const Eigen::Matrix3d R_world_body =
      travelAxes(T_world_cam_.rotation() * segment.velocity_mps, upInWorld(scene, T_world_cam_));
  object.birthplace_world = T_world_cam_ * segment.centroid_cam;
  const SE3 T_world_body(R_world_body, object.birthplace_world);
  object.T_cam_body = object.T_cam_body_before = T_world_cam_.inverse() * T_world_body;
  for (const int i : segment.points) {
    object.points.push_back(adopt_.toBody(object, scene.points[i]));
    taken[i] = true;
  }
  ObjectObservation first = motion_.firstSight(object, scene);
  first.frame = scene.frame;

  const Eigen::Matrix3d R_body_cam = R_world_body.transpose() * T_world_cam_.rotation();
  const Eigen::Vector3d v_body = R_body_cam * segment.velocity_mps;
  Vector6d twist;
  twist << v_body, Eigen::Vector3d::Zero();
  ObjectKinematics::Matrix12d P = ObjectKinematics::Matrix12d::Zero();
  P.topLeftCorner<6, 6>() = first.encounter_covariance;
  P.block<3, 3>(6, 6) =
      R_body_cam * segment.velocity_covariance * R_body_cam.transpose() + 0.25 * Eigen::Matrix3d::Identity();
  P.bottomRightCorner<3, 3>().diagonal().setConstant(params_.birth_turn_rate_radps * params_.birth_turn_rate_radps);
  object.kinematics = ObjectKinematics(T_world_body, twist, P);
  object.observations = 1;
  object.seen_before = scene.frame;
  first.velocity_cam_mps = segment.velocity_mps;
  object.backlog.push_back(std::move(first));
  objects_.push_back(std::move(object));
}

/// Of two objects on one vehicle the older stays and takes the points of the younger.
void ObjectTracker::mergeTwins() {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    for (std::size_t j = i + 1; j < objects_.size(); ++j) {
      TrackedObject &older = objects_[i], &younger = objects_[j];
      if (older.ended || younger.ended || !areTwins(older, younger)) continue;
      const SE3 T_older_younger = older.T_cam_body.inverse() * younger.T_cam_body;
      for (auto& p : younger.points) {
        p.p_body = T_older_younger * p.p_body;
        p.covariance = T_older_younger.rotation() * p.covariance * T_older_younger.rotation().transpose();
        p.misfits = 0;
      }
      older.adopt(younger.points);
      younger.ended = true;
    }
  }
}

bool ObjectTracker::areTwins(const TrackedObject& older, const TrackedObject& younger) const {
  const SE3 T_older_younger = older.T_cam_body.inverse() * younger.T_cam_body;
  const Eigen::AlignedBox3d own = older.core(SE3{}), other = younger.core(T_older_younger);
  if (older.coasted > 0 && younger.observations > 1)
    return false;  // one that is seen longer than the other was lost is not the other
  const double slack_m = std::min(params_.twin_slack_m, 2 * std::hypot(placeSigma_m(older), placeSigma_m(younger)));
  const bool one_vehicle = params_.adoption.vehicle.holds(own.merged(other), slack_m);
  if (!one_vehicle && !within(younger, T_older_younger, older) && !within(older, T_older_younger.inverse(), younger))
    return false;
  const Eigen::Vector3d dv =
      older.velocityAt_mps(T_older_younger.translation()) - younger.kinematics.velocityWorld_mps();
  const double sigma_mps = std::hypot(older.kinematics.speedSigma_mps(), younger.kinematics.speedSigma_mps());
  return dv.norm() < params_.twin_speed_mps + (one_vehicle ? 2 * sigma_mps : 0);
}

void ObjectTracker::bury(FrameMeasurements& measurements) {
  for (const auto& object : objects_)
    if (object.ended && object.confirmed) measurements.ended.push_back(object.track);
  std::erase_if(objects_, [](const auto& o) { return o.ended; });
}

std::vector<Parameter> parametersOf(ObjectTracker::Params& params) {
  return {
      numberParameter("confirm_observations", params.confirm_observations, {1, 10},
                      "fewer report an object earlier, more surely"),
      numberParameter("confirm_speed_mps", params.confirm_speed_mps, {0, 10}, "lower reports slower objects"),
      numberParameter("confirm_travel_m", params.confirm_travel_m, {0, 10},
                      "lower reports an object earlier, higher more surely"),
      numberParameter("look_back_frames", params.look_back_frames, {0, 50},
                      "more fill in an object's path before it was confirmed"),
      numberParameter("max_coasted_frames", params.max_coasted_frames, {0, 5},
                      "rows in state `predicted` while an object is not seen"),
      numberParameter("max_lost_frames", params.max_lost_frames, {0, 100},
                      "longer keeps the id of an object that is hidden"),
      numberParameter("stop_speed_mps", params.stop_speed_mps, {0, 0.75},
                      "an object that is slower for some frames is reported as stopped"),
      numberParameter("start_speed_mps", params.start_speed_mps, {0.75, 5}, "and one that is faster as moving again")};
}

}  // namespace motorcade
