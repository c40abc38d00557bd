#include "frontend/tracking/small_body.hpp"

#include "core/elementary.hpp"

namespace motorcade {

bool mayBeSmall(const TrackedObject& object) {
  constexpr double kLongest_m = 2;  // a bicycle, and the diagonal of who walks beside one
  if (object.kinematics.speed_mps() > kFastestRide_mps) return false;
  const Eigen::Vector3d size_m = object.core(SE3{}).sizes();
  return hypotenuse(size_m.x(), size_m.y()) < kLongest_m;
}

bool mayBeOnFoot(const TrackedObject& object) {
  return mayBeSmall(object) && (object.born_slow || object.kinematics.speed_mps() <= kFastestWalk_mps);
}

bool isWalk(double speed_mps, double z_m, const StereoCamera& camera) {
  constexpr double kBehind_m = 0.5, kSigma_px = 0.3;  // of a patch's disparity
  if (speed_mps < kSlowestWalk_mps || speed_mps > kFastestWalk_mps) return false;
  return camera.fx_px * camera.baseline_m * kBehind_m > kSigma_px * z_m * z_m;
}

bool mayBeWalking(const TrackedObject& object, const StereoCamera& camera) {
  return isWalk(object.kinematics.speed_mps(), object.T_cam_body.translation().z(), camera) && mayBeSmall(object);
}

ObjectKinematics::Params kinematicsOf(const TrackedObject& object, const ObjectKinematics::Params& vehicle) {
  constexpr double kAcceleration_mps2 = 0.5;  // a walk's speed is constant to a third
  constexpr double kAside_mps = 1;            // of a velocity whose direction few points told
  if (object.kinematics.speed_mps() > kFastestWalk_mps || !mayBeSmall(object)) return vehicle;
  ObjectKinematics::Params walk = vehicle;
  walk.acceleration.along_mps2 = walk.acceleration.sideways_mps2 = kAcceleration_mps2;
  walk.slip_mps = kAside_mps;
  return walk;
}

std::optional<Trunk> trunkOf(const TrackedObject& object, const SE3& T_cam_body, const GroundPlane& ground,
                             const StereoCamera& camera) {
  constexpr double kHip_m = 0.8, kHead_m = 1.8, kHalfWidth_m = 0.3;
  const Eigen::Vector3d middle = T_cam_body * object.middle();
  const double height_m = ground.heightOf_m(middle);
  const auto at_height = [&](double h_m) { return camera.project(middle + (height_m - h_m) * ground.normal_cam); };
  const auto head = at_height(kHead_m), hip = at_height(kHip_m), uvd_px = camera.project(middle);
  if (!head || !hip || !uvd_px) return std::nullopt;
  const double half_px = kHalfWidth_m * camera.fx_px / middle.z();
  return Trunk{{uvd_px->x() - half_px, head->y(), uvd_px->x() + half_px, hip->y()}, uvd_px->z()};
}

}  // namespace motorcade
