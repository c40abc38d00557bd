#pragma once

#include "backend/graph/factor.hpp"
#include "core/constant_twist.hpp"

/// Factors on how vehicles move between frames.
namespace motorcade {

/// White noise on acceleration between the poses and twists of a body at two moments (Barfoot, State Estimation for
/// Robotics, 2017, section 11.1, mirrored to right perturbations). With the body's poses c seen from the camera, the
/// camera's motion u between them and xi = log(c_a^-1 u c_b),
///   r = [xi - dt w_a; Jr^-1(xi) w_b - w_a],   covariance q (dt^3/3, dt^2/2; dt^2/2, dt)
/// where Jr^-1(xi) w ~ w + 1/2 ad(xi) w, as vehicles turn little between frames. The noise q differs along the axes of
/// travel, which are turned from the body's by `R_body_travel`.
class ConstantTwistFactor final : public JacobianFactor {
 public:
  struct Variables {
    VariableId c_a, w_a, c_b, w_b;
    VariableId x_a, x_b;  // the camera's poses, u = x_a^-1 x_b; invalid where u is known
  };
  /// `u` is used where the camera's poses are no variables.
  ConstantTwistFactor(const Variables& variables, const SE3& u, double dt_s, const Vector6d& acceleration_density,
                      const Eigen::Matrix3d& R_body_travel = Eigen::Matrix3d::Identity());

  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override;

 private:
  SE3 cameraMotion(std::span<const Value* const> values) const;

  SE3 u_;
  double dt_s_;
  Matrix6d root_;  // of the information, in the axes of travel
};

/// Axes of travel of a body, from a vector [lever; yaw; pitch]. Its rear axle may be `lever` behind its origin, and the
/// axes of travel (x ahead, z up) are the body's turned by R_z(yaw) R_y(pitch). The body's own axes are its gauge and
/// stay as they were at birth, so the direction of travel is learned without turning the whole path.
Eigen::Matrix3d travelAxes(const SmallVector& travel);

/// Departures of a vehicle from rolling: standard deviations of its velocity sideways and of its climbing.
struct RollingNoise {
  double sideways_mps = 0.3, vertical_mps = 0.2;
};

/// A vehicle rolls: no side slip of its rear axle and no climbing, in the axes of travel:
///   r = [(v_y - lever turn_z) / sideways; v_z / vertical]
class RollingFactor final : public JacobianFactor {
 public:
  RollingFactor(VariableId w, VariableId travel, const RollingNoise& noise);
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override;

 private:
  RollingNoise noise_;
};

/// Holds a vector at a mean, by independent standard deviations: r = (v - mean) / sigma.
class VectorPriorFactor final : public JacobianFactor {
 public:
  VectorPriorFactor(VariableId v, const SmallVector& mean, const SmallVector& sigma);
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override;

 private:
  SmallVector mean_, inverse_sigma_;
};

}  // namespace motorcade
