#include "frontend/tracking/look_back.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/LU>

#include "core/decompositions.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

/// Drops points that the object was given, but that were not measured to move with it yet.
void dropNew(TrackedObject& object) {
  std::erase_if(object.points, [&](const BodyPoint& point) {
    return std::ranges::none_of(object.backlog, [&](const ObjectObservation& o) {
      return std::ranges::find(o.measured, point.point, &PointMeasurement::point) != o.measured.end();
    });
  });
}

/// True when a body may have been there, where its kinematics predict it.
bool mayBe(const SE3& T_world_body, const ObjectKinematics& predicted) {
  constexpr double kChi2 = 11.3;  // 99 % of 3 degrees of freedom
  const Eigen::Vector3d off_m = (predicted.pose().inverse() * T_world_body).translation();
  const Eigen::Matrix3d covariance = predicted.poseCovariance().topLeftCorner<3, 3>();
  return off_m.dot(covariance.inverse() * off_m) < kChi2;
}

}  // namespace

void LookBack::operator()(TrackedObject& object, Timestamp now, const ObjectKinematics::Params& kinematics) const {
  auto earlier = past_.rbegin();
  while (earlier != past_.rend() && earlier->scene->head.frame > object.backlog.front().frame) ++earlier;
  if (earlier == past_.rend()) return;
  TrackedObject body = object;
  dropNew(body);
  const TrackedObject followed = body;
  MeasuredPoints later;
  if (earlier->scene->head.frame == object.backlog.front().frame) {
    const SE3& T_cam_body = object.backlog.front().T_cam_body;
    later = motion_.measuredPoints(body, *earlier->scene);
    motion_.addPatches(*earlier->scene, T_cam_body, body, later);
    motion_.addNearby(*earlier->scene, T_cam_body, body, later);
    ++earlier;
  }
  ObjectKinematics then = object.kinematics;
  for (int k = 0; k < frames_ && earlier != past_.rend(); ++k, ++earlier) {
    then.predict(secondsBetween(now, earlier->scene->head.stamp), kinematics);
    now = earlier->scene->head.stamp;
    auto observation = observe(*earlier, followed, body, then, later);
    if (!observation || isTaken(*earlier, observation->T_cam_body, object.born_slow)) return;
    // A point only near the object then is evidence of it, but surely a point of it only if it was followed later.
    std::erase_if(observation->measured, [&](const PointMeasurement& p) { return !followed.find(p.point); });
    const bool stands = object.born_slow && then.speed_mps() < kSlowestWalk_mps;
    if (stands && observation->measured.empty()) return;
    object.backlog.insert(object.backlog.begin(), std::move(*observation));
  }
}

/// Looks for the object in an earlier frame; `then` and `later` become what is known of it there. Points near it may
/// rest. Without any that are surely its own, they tell nothing of a person, who stands before them, and of a vehicle
/// only what was to be expected.
std::optional<ObjectObservation> LookBack::observe(const PastScene& earlier, const TrackedObject& followed,
                                                   TrackedObject& object, ObjectKinematics& then,
                                                   MeasuredPoints& later) const {
  const PosePrior prior{earlier.T_world_cam.inverse() * then.pose(), inverse(then.poseCovariance())};
  const auto is_own = [&](const PointMeasurement& p) { return followed.find(p.point) != nullptr; };
  const auto believed = [&](const ObjectMotionEstimator::Found& found) {
    return std::ranges::any_of(found.observation.measured, is_own) ||
           (!object.born_slow && mayBe(earlier.T_world_cam * found.fit.T_cam_ref, then));
  };
  std::optional<ObjectObservation> observation;
  auto found = motion_.lookBack(object, *earlier.scene, later, prior);
  if (found && believed(*found)) {
    then.acceptPose((earlier.T_world_cam * found->fit.T_cam_ref).normalized(), found->fit.covariance);
    later = std::move(found->points);
    motion_.addNearby(*earlier.scene, found->fit.T_cam_ref, object, later);
    observation = std::move(found->observation);
  } else if (then.positionSigma_m() < ObjectMotionEstimator::kMaxEvidenceSigma_m) {
    observation = motion_.visibleEvidence(object, *earlier.scene, prior);
  }
  if (!observation) return std::nullopt;
  observation->frame = earlier.scene->head.frame;
  observation->velocity_cam_mps = earlier.T_world_cam.rotation().transpose() * then.velocityWorld_mps();
  return observation;
}

/// True when a body was reported there, so that one would be reported twice. A tall one reaches far from its origin.
bool LookBack::isTaken(const PastScene& scene, const SE3& T_cam_body, bool small) {
  // Between the origins of two bodies on one vehicle, and on one person.
  constexpr double kOnVehicle_m = 2.5, kAside_m = 1.2, kOnPerson_m = 0.8;
  const double along_m = small ? kOnPerson_m : kOnVehicle_m, aside_m = small ? kOnPerson_m : kAside_m;
  return std::ranges::any_of(scene.reported, [&](const Body& other) {
    const Eigen::Vector3d apart = (T_cam_body.inverse() * other.T_cam_body).translation().cwiseAbs();
    if (apart.x() < along_m && apart.y() < aside_m) return true;
    Eigen::AlignedBox3d both = other.core;
    both.extend((other.T_cam_body.inverse() * T_cam_body).translation());
    return isTall(other.core) && kTallVehicle.holds(both, 0);
  });
}

void LookBack::remember(const SceneMotionPtr& scene, const SE3& T_world_cam,
                        const std::vector<ObjectObservation>& reported, const std::vector<TrackedObject>& objects) {
  past_.push_back({scene, T_world_cam, {}});
  for (const ObjectObservation& o : reported) {
    const auto object = std::ranges::find(objects, o.track, &TrackedObject::track);
    if (o.frame == scene->head.frame && object != objects.end())
      past_.back().reported.push_back({o.T_cam_body, object->core(SE3{})});
  }
  if (static_cast<int>(past_.size()) > kept_) past_.pop_front();
}

}  // namespace motorcade
