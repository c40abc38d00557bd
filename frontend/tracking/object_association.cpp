#include "frontend/tracking/object_association.hpp"

#include <Eigen/LU>

#include "core/assignment.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/see_through.hpp"

namespace motorcade {
namespace {

constexpr double kGateChi2 = 16.0;         // position and velocity over the ground, 4 degrees of freedom: 99.7 %
constexpr double kCentroidSpread_m = 1.5;  // standard deviation of a component's centroid about the body's origin
constexpr double kVelocitySpread_mps = 1.0;
constexpr double kDepthNoise = 0.02;         // of the centroid, over its depth: the errors that its points share
constexpr double kSharedPointsBonus = 20.0;  // cost taken off when all points of the component are the object's
                                             // already: beyond the gate, as points outweigh any distance within it
constexpr double kClaimedShare = 0.3;        // a component of whose points this share is an object's belongs to it,
                                             // whatever the distance
constexpr double kForbidden = 1e6;           // cost of a pair that must not match

/// Projects world coordinates onto the road: two axes across its normal.
Eigen::Matrix<double, 2, 3> overGround(const SceneMotion& scene, const SE3& T_world_cam) {
  const Eigen::Matrix3d& R = T_world_cam.rotation();
  const Eigen::Vector3d up = upInWorld(scene, T_world_cam);
  Eigen::Matrix<double, 2, 3> over_ground;
  over_ground.row(0) = R.col(0).transpose();
  over_ground.row(1) = up.cross(R.col(0)).normalized().transpose();
  return over_ground;
}

double cost(const TrackedObject& object, const SceneMotion& scene, const MotionComponent& component,
            const SE3& T_world_cam) {
  const Eigen::Matrix3d& R = T_world_cam.rotation();
  const Eigen::Matrix<double, 2, 3> over_ground = overGround(scene, T_world_cam);
  const auto& k = object.kinematics;
  const Eigen::Matrix3d R_body = k.pose().rotation();
  const Eigen::Vector2d dp = over_ground * (T_world_cam * component.centroid_cam - k.pose().translation());
  const Eigen::Vector2d dv = over_ground * (R * component.velocity_mps - k.velocityWorld_mps());
  Eigen::Matrix2d S_p =
      over_ground * R_body * k.poseCovariance().topLeftCorner<3, 3>() * R_body.transpose() * over_ground.transpose();
  const Eigen::Matrix3d C_v =
      R * component.velocity_covariance * R.transpose() + R_body * k.velocityCovariance() * R_body.transpose();
  Eigen::Matrix2d S_v = over_ground * C_v * over_ground.transpose();
  const double depth_noise_m = kDepthNoise * component.centroid_cam.z();
  S_p.diagonal().array() += kCentroidSpread_m * kCentroidSpread_m + depth_noise_m * depth_noise_m;
  S_v.diagonal().array() += kVelocitySpread_mps * kVelocitySpread_mps;
  const double chi2 = dp.dot(S_p.inverse() * dp) + dv.dot(S_v.inverse() * dv);
  const double shared = sharedPoints(object, scene, component);
  if (chi2 > kGateChi2 && shared < kClaimedShare) return kForbidden;
  return chi2 - kSharedPointsBonus * shared;
}

/// Gives left-over components to the object whose points they hold, as a vehicle may fall into several components.
void claimRest(const std::vector<TrackedObject>& objects, const SceneMotion& scene, std::vector<int>& object_of) {
  for (std::size_t s = 0; s < scene.components.size(); ++s) {
    if (scene.components[s].label != PointLabel::kMoving || object_of[s] >= 0) continue;
    for (std::size_t m = 0; m < objects.size(); ++m)
      if (!objects[m].isGuess() && sharedPoints(objects[m], scene, scene.components[s]) >= kClaimedShare)
        object_of[s] = static_cast<int>(m);
  }
}

}  // namespace

double sharedPoints(const TrackedObject& object, const SceneMotion& scene, const MotionComponent& component) {
  int shared = 0;
  for (const int i : component.points) shared += object.find(scene.points[i].point) != nullptr;
  return static_cast<double>(shared) / static_cast<double>(component.points.size());
}

std::vector<int> associateObjects(const std::vector<TrackedObject>& objects, const SceneMotion& scene,
                                  const SE3& T_world_cam, const StereoCamera& camera) {
  const auto components = static_cast<int>(scene.components.size()), known = static_cast<int>(objects.size());
  if (components == 0 || known == 0) return std::vector<int>(components, -1);
  const SeeThrough see_through(scene, camera);
  Eigen::MatrixXd costs = Eigen::MatrixXd::Constant(components, known, kForbidden);
  for (int s = 0; s < components; ++s) {
    if (scene.components[s].label != PointLabel::kMoving) continue;
    for (int m = 0; m < known; ++m) {
      if (objects[m].isGuess()) continue;
      costs(s, m) = cost(objects[m], scene, scene.components[s], T_world_cam);
      if (costs(s, m) < kForbidden && sharedPoints(objects[m], scene, scene.components[s]) < kClaimedShare &&
          see_through.isApart(objects[m], scene.components[s]))
        costs(s, m) = kForbidden;
    }
  }
  std::vector<int> object_of = assignMinCost(costs, kForbidden);
  claimRest(objects, scene, object_of);
  return object_of;
}

}  // namespace motorcade
