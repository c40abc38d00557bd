#pragma once

#include <utility>
#include <vector>

#include "motorcade/motorcade.hpp"
#include "tests/apps/bridge/results_by_hand.hpp"

/// A result of one object, for tests of the messages about objects.
namespace motorcade::test {

inline constexpr std::int64_t kBridgedStamp_ns = 5'000'000'250;

/// The pose of the camera of `bridgedResult`.
inline SE3 bridgedCamera() { return turned({0.02, -0.01, 0.6}, {30, -4, 0.5}); }

/// A van ahead that drives a bend; neither its axes nor its motion lie along an axis of the world.
inline Result::Object bridgedObject() {
  const SE3 T_world_body = turned({0.05, -0.1, 1.1}, {42, 9, -0.3});
  Result::Object object;
  object.id = 7;
  object.T_world_body = rowsByHand(T_world_body);
  object.T_cam_body = rowsByHand(bridgedCamera().inverse() * T_world_body);
  object.covariance = rowsByHand(Matrix6d(0.1 * unevenCovariance()));
  object.velocity_world_mps = {3, 7, 0.2};
  object.velocity_covariance = {0.30, 0.05, 0.01, 0.05, 0.20, 0.02, 0.01, 0.02, 0.10};
  object.yaw_rate_radps = 0.4;
  object.yaw_rate_sigma_radps = 0.05;
  object.existence_probability = 0.75;
  object.points = 12;
  object.box_center_body_m = {-1, 0.2, 0.6};
  object.box_size_m = {5, 2, 2.2};
  object.box_size_sigma_m = {0.4, 0.2, 0.1};
  object.box_center_sigma_m = {0.6, 0.2, 0.07};
  object.kind = Result::Kind::kCar;
  object.kind_probability = 0.8;
  object.acceleration = {.along_mps2 = -1.5, .along_sigma_mps2 = 0.4, .yaw_radps2 = 0.3, .yaw_sigma_radps2 = 0.2};
  return object;
}

inline Result bridgedResult(std::vector<Result::Object> objects) {
  Result result;
  result.frame = 3;
  result.stamp_ns = kBridgedStamp_ns;
  result.T_world_cam = rowsByHand(bridgedCamera());
  result.objects = std::move(objects);
  return result;
}

inline SE3 boxOfBridged(const SE3& T_parent_body) {
  const auto& [x, y, z] = bridgedObject().box_center_body_m;
  return T_parent_body * SE3(Eigen::Matrix3d::Identity(), {x, y, z});
}

/// The variances of its cuboid's middle in the body.
inline Eigen::Vector3d bridgedMiddle() { return Eigen::Vector3d(0.6, 0.2, 0.07).cwiseAbs2(); }

/// The perturbation of a message's pose: of the position, and the rotation about axes of the parent frame.
inline Vector6d rosDifference(const SE3& moved, const SE3& T) {
  Vector6d difference;
  difference << moved.translation() - T.translation(), logSO3(moved.rotation() * T.rotation().transpose());
  return difference;
}

}  // namespace motorcade::test
