#include "frontend/tracking/object_spawner.hpp"

#include <utility>

#include "frontend/segmentation/vehicles_abreast.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/small_body.hpp"
#include "frontend/tracking/vehicle_size.hpp"

namespace motorcade {
namespace {

constexpr double kTurnRate_radps = 0.05;  // standard deviation of an object's turn rate, of which nothing is known
constexpr double kSpeedModel_mps = 0.5;   // that of its velocity beyond the segment's own: not all points are its own

/// The segment's velocity, without turning, about the pose that the first observation measured.
ObjectKinematics firstKinematics(const SE3& T_world_body, const Segment& vehicle, const SE3& T_world_cam,
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

}  // namespace

std::vector<TrackedObject> ObjectSpawner::operator()(const SceneMotion& scene, const Segment& segment,
                                                     const SE3& T_world_cam, std::vector<bool>& taken) {
  std::vector<int> free;
  for (const int i : segment.points)
    if (!taken[i]) free.push_back(i);
  std::vector<TrackedObject> spawned;
  for (const Segment& vehicle : splitAbreast(segment, free, scene, kOrdinaryVehicle.width_m)) {
    if (static_cast<int>(vehicle.points.size()) < min_points_) continue;
    for (const int i : vehicle.points) taken[i] = true;
    spawned.push_back(spawn(scene, vehicle, T_world_cam));
  }
  return spawned;
}

TrackedObject ObjectSpawner::spawn(const SceneMotion& scene, const Segment& vehicle, const SE3& T_world_cam) {
  TrackedObject object;
  object.track = TrackId{next_track_++};
  object.spawned_at_world = T_world_cam * vehicle.centroid_cam;
  const SE3 T_world_body(travelAxes(T_world_cam.rotation() * vehicle.velocity_mps, upInWorld(scene, T_world_cam)),
                         object.spawned_at_world);
  object.T_cam_body = object.T_cam_body_before = T_world_cam.inverse() * T_world_body;
  for (const int i : vehicle.points) object.points.push_back(toBody(scene.points[i], object.T_cam_body, camera_));
  ObjectObservation first = motion_.firstObservation(object, scene);
  first.frame = scene.frame;
  first.velocity_cam_mps = vehicle.velocity_mps;
  object.kinematics = firstKinematics(T_world_body, vehicle, T_world_cam, first.encounter_covariance);
  object.observed_before = scene.frame;
  if (mayBeWalking(object, camera_)) {
    object.measured = motion_.measuredPoints(object, scene);
    motion_.addPatches(scene, object.T_cam_body, object, object.measured);
  }
  object.backlog.push_back(std::move(first));
  return object;
}

}  // namespace motorcade
