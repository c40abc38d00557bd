#include "vehicle_frame.hpp"

#include <algorithm>
#include <cmath>

namespace vehicle_stack {
namespace {

struct Pose {
  Matrix3 R;
  Vector3 t_m;
};

Pose poseOf(const std::array<double, 12>& T) {
  return {.R = {{T[0], T[1], T[2], T[4], T[5], T[6], T[8], T[9], T[10]}}, .t_m = {{T[3], T[7], T[11]}}};
}

Matrix3 rotationOf(const Mounting& mounting) {
  const double cr = std::cos(mounting.roll_rad), sr = std::sin(mounting.roll_rad);
  const double cp = std::cos(mounting.pitch_rad), sp = std::sin(mounting.pitch_rad);
  const double cy = std::cos(mounting.yaw_rad), sy = std::sin(mounting.yaw_rad);
  const Matrix3 about_x{{1, 0, 0, 0, cr, -sr, 0, sr, cr}};
  const Matrix3 about_y{{cp, 0, sp, 0, 1, 0, -sp, 0, cp}};
  const Matrix3 about_z{{cy, -sy, 0, sy, cy, 0, 0, 0, 1}};
  return about_z * about_y * about_x;
}

/// T exp(rho, phi) moves the origin by R rho, and turns by R phi in the axes that T leads to.
Matrix6 poseJacobian(const Matrix3& R) {
  Matrix6 J;
  setBlock(J, 0, 0, R);
  setBlock(J, 3, 3, R);
  return J;
}

/// T exp(rho, phi) moves the body's point c by R (rho - [c]x phi).
Matrix<3, 6> pointJacobian(const Matrix3& R, const Vector3& c_body_m) {
  Matrix<3, 6> J;
  setBlock(J, 0, 0, R);
  setBlock(J, 0, 3, -1 * (R * crossMatrix(c_body_m)));
  return J;
}

/// The camera at t moves with v_cam = R' (v + w x t) and turns with R' w, so that v = R v_cam + [t]x R w_cam.
Matrix6 motionJacobian(const Matrix3& R, const Vector3& t_m) {
  Matrix6 J = poseJacobian(R);
  setBlock(J, 0, 3, crossMatrix(t_m) * R);
  return J;
}

}  // namespace

std::array<double, 4> quaternionOf(const Matrix3& R) {
  const auto half = [](double square) { return 0.5 * std::sqrt(std::max(0.0, square)); };
  const double w = half(1 + R(0, 0) + R(1, 1) + R(2, 2)), x = half(1 + R(0, 0) - R(1, 1) - R(2, 2));
  const double y = half(1 - R(0, 0) + R(1, 1) - R(2, 2)), z = half(1 - R(0, 0) - R(1, 1) + R(2, 2));
  // The signs are those against the largest part, which alone is safe to divide by.
  if (w >= std::max({x, y, z}))
    return {std::copysign(x, R(2, 1) - R(1, 2)), std::copysign(y, R(0, 2) - R(2, 0)),
            std::copysign(z, R(1, 0) - R(0, 1)), w};
  if (x >= std::max(y, z))
    return {x, std::copysign(y, R(0, 1) + R(1, 0)), std::copysign(z, R(0, 2) + R(2, 0)),
            std::copysign(w, R(2, 1) - R(1, 2))};
  if (y >= z)
    return {std::copysign(x, R(0, 1) + R(1, 0)), y, std::copysign(z, R(1, 2) + R(2, 1)),
            std::copysign(w, R(0, 2) - R(2, 0))};
  return {std::copysign(x, R(0, 2) + R(2, 0)), std::copysign(y, R(1, 2) + R(2, 1)), z,
          std::copysign(w, R(1, 0) - R(0, 1))};
}

VehicleFrame::VehicleFrame(const Mounting& mounting, double margin)
    : R_vehicle_cam_(rotationOf(mounting)),
      t_vehicle_cam_m_{{mounting.x_m, mounting.y_m, mounting.z_m}},
      variance_factor_(margin * margin) {}

VehicleObject VehicleFrame::object(const motorcade::Result& result, const motorcade::Result::Object& object) const {
  const Pose cam_body = poseOf(object.T_cam_body);
  const Matrix3 R = R_vehicle_cam_ * cam_body.R;
  const Matrix3 R_vehicle_world = R_vehicle_cam_ * transposed(poseOf(result.T_world_cam).R);
  VehicleObject converted;
  converted.position_m = R_vehicle_cam_ * cam_body.t_m + t_vehicle_cam_m_;
  converted.R_vehicle_body = R;
  converted.velocity_mps = R_vehicle_world * Vector3{object.velocity_world_mps};
  converted.velocity_covariance = variance_factor_ * propagated(R_vehicle_world, Matrix3{object.velocity_covariance});
  if (object.covariance)
    converted.pose_covariance = variance_factor_ * propagated(poseJacobian(R), Matrix6{*object.covariance});
  if (object.box_size_m[0] > 0) {
    const Vector3 center_body_m{object.box_center_body_m};
    VehicleObject::Box box{.center_m = R * center_body_m + converted.position_m,
                           .size_m = {object.box_size_m},
                           .size_sigma_m = {object.box_size_sigma_m},
                           .center_covariance = {}};
    if (object.covariance)
      box.center_covariance =
          variance_factor_ * propagated(pointJacobian(R, center_body_m), Matrix6{*object.covariance});
    converted.box = box;
  }
  return converted;
}

VehicleMotionSample VehicleFrame::motion(const motorcade::Result& result) const {
  const Matrix6 J = motionJacobian(R_vehicle_cam_, t_vehicle_cam_m_);
  return {.velocity = J * Matrix<6, 1>{result.velocity},
          .covariance = variance_factor_ * propagated(J, Matrix6{result.velocity_covariance})};
}

}  // namespace vehicle_stack
