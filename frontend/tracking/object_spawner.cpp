#include "frontend/tracking/object_spawner.hpp"

#include <utility>

#include <Eigen/LU>

#include "frontend/motion/shared_velocity_error.hpp"
#include "frontend/segmentation/motion_segmenter.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

constexpr double kTurnRate_radps = 0.05;  // standard deviation of an object's turn rate, of which nothing is known
constexpr double kSure = 3;               // standard deviations of a walk, which is confirmed by as many
constexpr double kSpeedModel_mps = 0.5;   // that of its velocity beyond the component's own: not all points are its own

/// Kinematics with the component's velocity, without turning, about the pose that the first observation measured.
ObjectKinematics firstKinematics(const SE3& T_world_body, const MotionComponent& vehicle, const SE3& T_world_cam,
                                 const Matrix6d& pose_covariance) {
  const Eigen::Matrix3d R_body_cam = T_world_body.rotation().transpose() * T_world_cam.rotation();
  const Eigen::Vector3d v_body = R_body_cam * vehicle.velocity_mps;
  Vector6d twist;
  twist << v_body, Eigen::Vector3d::Zero();
  Matrix12d P = Matrix12d::Zero();
  P.topLeftCorner<6, 6>() = pose_covariance;
  P.block<3, 3>(6, 6) = R_body_cam * vehicle.velocity_covariance * R_body_cam.transpose() +
                        kSpeedModel_mps * kSpeedModel_mps * Eigen::Matrix3d::Identity();
  P.bottomRightCorner<3, 3>().diagonal().setConstant(kTurnRate_radps * kTurnRate_radps);
  return {T_world_body, twist, P};
}

bool isSure(const Eigen::Vector3d& velocity_mps, const Eigen::Matrix3d& covariance) {
  return velocity_mps.dot(covariance.inverse() * velocity_mps) > kSure * kSure;
}

}  // namespace

std::vector<TrackedObject> ObjectSpawner::operator()(const SceneMotion& scene, const MotionComponent& component,
                                                     const SE3& T_world_cam, std::vector<bool>& taken) {
  std::vector<int> free;
  for (const int i : component.points)
    if (!taken[i]) free.push_back(i);
  std::vector<TrackedObject> spawned;
  for (const MotionComponent& vehicle : splitAbreast(component, free, scene, kOrdinaryVehicle.width_m)) {
    if (static_cast<int>(vehicle.points.size()) < min_points_) continue;
    for (const int i : vehicle.points) taken[i] = true;
    spawned.push_back(objectOf(scene, vehicle, T_world_cam));
    spawned.back().track = newTrack();
  }
  return spawned;
}

bool ObjectSpawner::mayBeWalker(const MotionComponent& component, const GroundPlane& ground) const {
  constexpr double kHighest_m = 2;
  return isWalk(component.velocity_mps.norm(), component.centroid_cam.z(), camera_) &&
         ground.heightOf_m(component.centroid_cam) < kHighest_m &&
         isSure(component.velocity_mps, component.velocity_covariance);
}

std::optional<TrackedObject> ObjectSpawner::walker(const SceneMotion& scene, const SceneMotion& before,
                                                   const MotionComponent& component, const SE3& T_world_cam) {
  TrackedObject object = objectOf(scene, component, T_world_cam);
  if (!object.born_slow || !haveMoved(object, scene, before)) return std::nullopt;
  object.track = newTrack();
  return object;
}

/// Spawns an object; what it was seen to do before counts for its confirmation.
TrackedObject ObjectSpawner::region(const SceneMotion& scene, const RegionWalkers::Mover& mover,
                                    const SE3& T_world_cam) {
  TrackedObject object = objectOf(scene, mover.component, T_world_cam);
  object.track = newTrack();
  object.spawned_at_world -= mover.duration_s * (T_world_cam.rotation() * mover.component.velocity_mps);
  object.born_as_region = true;
  object.born_labelled = mover.labelled;
  for (int earlier = 1; earlier < mover.frames; ++earlier) object.life.observe();
  return object;
}

/// True when the patches have moved. They are looked for in the frame before where the velocity takes them from, and
/// one pose of the body must agree with most of them. How far it lies from the present pose is measured, not assumed.
bool ObjectSpawner::haveMoved(const TrackedObject& object, const SceneMotion& scene, const SceneMotion& before) const {
  constexpr double kMostAgree = 0.5;
  constexpr std::size_t kLeast = 8;  // patches, each of which shares half of its pixels with its neighbors
  constexpr double kPosition_m = 0.3, kRotation_rad = 0.05;  // by which the prediction may be wrong
  const double dt_s = secondsBetween(before.head.stamp, scene.head.stamp);
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kPosition_m), Eigen::Vector3d::Constant(kRotation_rad);
  const PosePrior predicted{
      scene.odometry.T_previous_now * object.T_cam_body * SE3::exp(-dt_s * object.kinematics.twist()),
      sigma.cwiseAbs2().cwiseInverse().asDiagonal()};
  const auto then = motion_.lookBack(object, before, object.measured, predicted);
  const std::size_t agree = then ? then->points.points.size() : 0, all = object.measured.points.size();
  if (agree < kLeast || static_cast<double>(agree) < kMostAgree * static_cast<double>(all)) return false;
  const SE3 T_then_now = then->fit.T_cam_ref.inverse() * scene.odometry.T_previous_now * object.T_cam_body;
  const Eigen::Vector3d velocity_mps = T_then_now.translation() / dt_s;
  const Eigen::Matrix3d R_cam_body = object.T_cam_body.rotation();
  const Eigen::Matrix3d shared =
      sharedVelocityCovariance(camera_, object.T_cam_body.translation(), scene.camera_speed_mps);
  const Eigen::Matrix3d C = then->fit.covariance.topLeftCorner<3, 3>() / (dt_s * dt_s);
  return velocity_mps.norm() < kFastestWalk_mps &&
         isSure(velocity_mps, C + R_cam_body.transpose() * shared * R_cam_body);
}

TrackedObject ObjectSpawner::objectOf(const SceneMotion& scene, const MotionComponent& vehicle,
                                      const SE3& T_world_cam) const {
  TrackedObject object;
  object.spawned_at_world = T_world_cam * vehicle.centroid_cam;
  const SE3 T_world_body(travelAxes(T_world_cam.rotation() * vehicle.velocity_mps, upInWorld(scene, T_world_cam)),
                         object.spawned_at_world);
  object.T_cam_body = T_world_cam.inverse() * T_world_body;
  for (const int i : vehicle.points) object.points.push_back(toBody(scene.points[i], object.T_cam_body, camera_));
  ObjectObservation first = motion_.firstObservation(object, scene);
  first.frame = scene.head.frame;
  first.velocity_cam_mps = vehicle.velocity_mps;
  object.kinematics = firstKinematics(T_world_body, vehicle, T_world_cam, first.encounter_covariance);
  object.born_slow = mayBeWalking(object, camera_);
  if (object.born_slow) {
    object.measured = motion_.measuredPoints(object, scene);
    motion_.addPatches(scene, object.T_cam_body, object, object.measured);
  }
  object.backlog.push_back(std::move(first));
  return object;
}

}  // namespace motorcade
