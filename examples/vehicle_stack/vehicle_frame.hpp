#pragma once

#include <array>
#include <optional>

#include <motorcade/motorcade.hpp>

#include "matrix.hpp"

namespace vehicle_stack {

/// Where the left camera sits in the vehicle frame (REP-103, base_link: x ahead, y left, z up), and its angles about
/// these axes, applied roll first: positive pitch looks down, positive yaw to the left.
struct Mounting {
  double x_m = 0, y_m = 0, z_m = 1.65;
  double roll_rad = 0, pitch_rad = 0, yaw_rad = 0;
};

/// An object in the vehicle frame. All covariances have their margin already.
struct VehicleObject {
  struct Box {
    Vector3 center_m, size_m, size_sigma_m;  // size along the body's axes: length, width, height
    std::optional<Matrix3> center_covariance;
  };
  Vector3 position_m;                      // of the body's origin
  Matrix3 R_vehicle_body;                  // the body's x axis points along its travel
  std::optional<Matrix6> pose_covariance;  // of position, then rotation, both along the vehicle's axes (as in ROS)
  Vector3 velocity_mps;                    // over ground, along the vehicle's axes
  Matrix3 velocity_covariance;
  std::optional<Box> box;
};

/// The vehicle's own motion, of its origin: velocity [m/s] and turn rate [rad/s] along its axes.
struct VehicleMotionSample {
  Matrix<6, 1> velocity;
  Matrix6 covariance;
};

/// Takes results of a tracker with `Axes::kRep103` to the vehicle frame. `margin` multiplies standard deviations.
class VehicleFrame {
 public:
  VehicleFrame(const Mounting& mounting, double margin);

  VehicleObject object(const motorcade::Result& result, const motorcade::Result::Object& object) const;
  /// Its covariance is wide where hardly anything is known, as in the first frame and in one that is lost.
  VehicleMotionSample motion(const motorcade::Result& result) const;

 private:
  Matrix3 R_vehicle_cam_;
  Vector3 t_vehicle_cam_m_;
  double variance_factor_;
};

/// x, y, z, w as ROS orders them.
std::array<double, 4> quaternionOf(const Matrix3& R);

}  // namespace vehicle_stack
