#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/se3.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// The road's normal, away from the ground.
inline Eigen::Vector3d upInWorld(const SceneMotion& scene, const SE3& T_world_cam) {
  return -(T_world_cam.rotation() * scene.ground.normal_cam);
}

/// Body axes for a direction of travel: x ahead over the ground, z up, y to the left.
inline Eigen::Matrix3d travelAxes(const Eigen::Vector3d& velocity, const Eigen::Vector3d& up) {
  const Eigen::Vector3d ahead = (velocity - up * up.dot(velocity)).normalized();
  Eigen::Matrix3d R;
  R << ahead, up.cross(ahead), up;
  return R;
}

/// A box that a vehicle's points fit into.
struct VehicleSize {
  double length_m, width_m, height_m;
  /// `slack_m` of length, width and height.
  bool holds(const Eigen::AlignedBox3d& box, const Eigen::Array3d& slack_m) const {
    return (box.sizes().array() < Eigen::Array3d(length_m, width_m, height_m) + slack_m).all();
  }
  bool holds(const Eigen::AlignedBox3d& box, double slack_m) const {
    return holds(box, Eigen::Array3d::Constant(slack_m));
  }
};

/// Size of a walking person, with arms and legs: two who walk side by side are farther apart.
constexpr VehicleSize kPerson{.length_m = 1.2, .width_m = 1.2, .height_m = 2.2};

/// Size of a car or a van with some margin, up to which points may be one body without further evidence.
constexpr VehicleSize kOrdinaryVehicle{.length_m = 6.0, .width_m = 2.8, .height_m = 3.2};

/// Size up to which points may be one tall body without further evidence. What is higher than a car is a van, a lorry
/// or a bus.
constexpr VehicleSize kTallVehicle{
    .length_m = 9.0, .width_m = kOrdinaryVehicle.width_m, .height_m = kOrdinaryVehicle.height_m};

/// True for a tall body, by the box around its points without outliers.
inline bool isTall(const Eigen::AlignedBox3d& core) {
  constexpr double kHigherThanACar_m = 2.0;
  return core.sizes().z() > kHigherThanACar_m;
}

/// Size of a lorry or a bus. Its length is found point by point; it is no wider or higher than others.
constexpr VehicleSize kLongestVehicle{
    .length_m = 14.0, .width_m = kOrdinaryVehicle.width_m, .height_m = kOrdinaryVehicle.height_m};

}  // namespace motorcade
