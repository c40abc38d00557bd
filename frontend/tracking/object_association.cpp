#include "frontend/tracking/object_association.hpp"

#include <limits>

#include <Eigen/LU>

#include "core/assignment.hpp"

namespace motorcade {
namespace {

constexpr double kForbidden = 1e6;

}  // namespace

double sharedPoints(const TrackedObject& object, const SceneMotion& scene, const Segment& segment) {
  int shared = 0;
  for (const int i : segment.points) shared += object.find(scene.points[i].point) != nullptr;
  return static_cast<double>(shared) / static_cast<double>(segment.points.size());
}

double ObjectAssociation::cost(const TrackedObject& object, const SceneMotion& scene, const Segment& segment,
                               const SE3& T_world_cam) const {
  const Eigen::Matrix3d& R = T_world_cam.rotation();
  const Eigen::Vector3d up = -(R * scene.ground.normal_cam);
  Eigen::Matrix<double, 2, 3> over_ground;  // projects onto the road: two axes across the normal
  over_ground.row(0) = R.col(0).transpose();
  over_ground.row(1) = up.cross(R.col(0)).normalized().transpose();

  const auto& k = object.kinematics;
  const Eigen::Matrix3d R_body = k.pose().rotation();
  const Eigen::Vector2d dp = over_ground * (T_world_cam * segment.centroid_cam - k.pose().translation());
  const Eigen::Vector2d dv = over_ground * (R * segment.velocity_mps - k.velocityWorld_mps());
  Eigen::Matrix2d S_p =
      over_ground * R_body * k.poseCovariance().topLeftCorner<3, 3>() * R_body.transpose() * over_ground.transpose();
  const Eigen::Matrix3d C_v =
      R * segment.velocity_covariance * R.transpose() + R_body * k.velocityCovariance() * R_body.transpose();
  Eigen::Matrix2d S_v = over_ground * C_v * over_ground.transpose();
  const double depth_noise_m = 0.02 * segment.centroid_cam.z();
  S_p.diagonal().array() += params_.centroid_spread_m * params_.centroid_spread_m + depth_noise_m * depth_noise_m;
  S_v.diagonal().array() += params_.velocity_spread_mps * params_.velocity_spread_mps;
  const double chi2 = dp.dot(S_p.inverse() * dp) + dv.dot(S_v.inverse() * dv);
  const double shared = sharedPoints(object, scene, segment);
  if (chi2 > params_.gate_chi2 && shared < params_.claimed_share) return kForbidden;
  return chi2 - params_.shared_points_bonus * shared;
}

std::vector<int> ObjectAssociation::operator()(const std::vector<TrackedObject>& objects, const SceneMotion& scene,
                                               const SE3& T_world_cam) const {
  std::vector<int> object_of(scene.segments.size(), -1);
  if (objects.empty() || scene.segments.empty()) return object_of;
  Eigen::MatrixXd costs = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(scene.segments.size()),
                                                    static_cast<Eigen::Index>(objects.size()), kForbidden);
  for (std::size_t s = 0; s < scene.segments.size(); ++s) {
    if (scene.segments[s].label != PointLabel::kMoving) continue;
    for (std::size_t m = 0; m < objects.size(); ++m)
      costs(static_cast<Eigen::Index>(s), static_cast<Eigen::Index>(m)) =
          cost(objects[m], scene, scene.segments[s], T_world_cam);
  }
  object_of = assignMinCost(costs, kForbidden);

  for (std::size_t s = 0; s < scene.segments.size(); ++s) {  // a vehicle may fall into several segments
    if (scene.segments[s].label != PointLabel::kMoving || object_of[s] >= 0) continue;
    for (std::size_t m = 0; m < objects.size(); ++m)
      if (sharedPoints(objects[m], scene, scene.segments[s]) >= params_.claimed_share)
        object_of[s] = static_cast<int>(m);
  }
  return object_of;
}

}  // namespace motorcade
