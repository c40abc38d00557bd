#include "core/object_place.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

constexpr double kUpright = 1e-12;  // sine of the angle to the vertical, squared: below, a body heads nowhere

}  // namespace

ObjectPlace placeOf(const ObjectEstimate& object) {
  const ObjectBox cuboid = object.cuboid.value_or(ObjectBox{});
  const Eigen::Matrix3d& R = object.T_world_body.rotation();
  const Eigen::Vector3d ahead = R.col(0);
  ObjectPlace place{.center_world = object.T_world_body * cuboid.center_body,
                    .heading_rad = arcTangent(-ahead.x(), ahead.z())};
  if (!object.covariance || !object.covariance->allFinite()) return place;

  Eigen::Matrix<double, 3, 6> J_center;
  J_center << R, -R * hat(cuboid.center_body);
  const Eigen::Matrix3d box_covariance = cuboid.center_sigma_m.cwiseAbs2().asDiagonal();
  place.center_covariance = J_center * *object.covariance * J_center.transpose() + R * box_covariance * R.transpose();

  const Eigen::Matrix3d J_ahead = -R * hat(Eigen::Vector3d::UnitX());
  const double horizontal = ahead.x() * ahead.x() + ahead.z() * ahead.z();
  if (horizontal < kUpright) {
    place.heading_sigma_rad = std::numbers::pi;
    return place;
  }
  const Eigen::RowVector3d J_heading = (ahead.x() * J_ahead.row(2) - ahead.z() * J_ahead.row(0)) / horizontal;
  const double variance = J_heading * object.covariance->bottomRightCorner<3, 3>() * J_heading.transpose();
  place.heading_sigma_rad = std::sqrt(std::max(0.0, variance));
  return place;
}

}  // namespace motorcade
