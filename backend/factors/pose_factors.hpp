#pragma once

#include <memory>

#include "backend/factors/pose_factor.hpp"
#include "core/constant_twist.hpp"

/// The factors of multibody VSLAM (Reddy et al. 2016, section V; anchors after Kim et al. 2010).
///
/// Equations 3 and 4 of the paper print the residuals as f(z_{i-1}, v_i) - z_{i-1} and h(z_{i'}, e) - z_{i'}, which
/// compare a prediction with the pose it was made from. Here they are f(z_{i-1}, v_i) - z_i and h(z_{i'}, e) - z_i, as
/// they are meant, with log(predicted^-1 * actual) as the difference of two poses.
/// In all of them a measured pose is M = true * exp(n), n ~ (0, covariance).
namespace motorcade {

/// r = log(mean^-1 * T)
struct PriorModel {
  SE3 mean;
  Vector6d residual(const std::array<SE3, 1>& T) const;
  PoseResidual<1> evaluate(const std::array<SE3, 1>& T) const;
};
using PriorFactor = PoseFactor<PriorModel, 1>;

/// Standard deviations of a pose: of its place along each axis, of its tilt about x and y, of its turn about z.
Vector6d poseSigmas(double sigma_m, double tilt_rad, double yaw_rad);
PoseNoise independentNoise(const Vector6d& sigma);
std::unique_ptr<const JacobianFactor> priorFactor(VariableId v, const SE3& mean, const Vector6d& sigma);

/// Odometry between successive camera poses, x_i = x_{i-1} u_i, and motion between successive object poses,
/// z_i = z_{i-1} v_i:
///   r = log(motion^-1 * T_before^-1 * T_now)
struct MotionModel {
  SE3 motion;  // T_before_now
  Vector6d residual(const std::array<SE3, 2>& before_now) const;
  PoseResidual<2> evaluate(const std::array<SE3, 2>& before_now) const;
};
using MotionFactor = PoseFactor<MotionModel, 2>;

/// The camera sees an object whose trajectory is anchored in the world:
///   r = log(T_cam_body^-1 * x^-1 * a * z)
struct CameraEncounterModel {
  SE3 T_cam_body;
  Vector6d residual(const std::array<SE3, 3>& x_a_z) const;
  PoseResidual<3> evaluate(const std::array<SE3, 3>& x_a_z) const;
};
using CameraEncounterFactor = PoseFactor<CameraEncounterModel, 3>;

/// Two objects at the same moment:
///   r = log(T_m_n^-1 * (a_m z_m)^-1 * (a_n z_n))
struct ObjectEncounterModel {
  SE3 T_m_n;
  Vector6d residual(const std::array<SE3, 4>& am_zm_an_zn) const;
  PoseResidual<4> evaluate(const std::array<SE3, 4>& am_zm_an_zn) const;
};
using ObjectEncounterFactor = PoseFactor<ObjectEncounterModel, 4>;

/// A vehicle keeps its twist in its own axes:
///   r = log(z_i^-1 z_{i+1}) / dt_after - log(z_{i-1}^-1 z_i) / dt_before    [m/s, rad/s]
struct SmoothMotionModel {
  double dt_before_s = 0, dt_after_s = 0;
  Vector6d residual(const std::array<SE3, 3>& z) const;
  PoseResidual<3> evaluate(const std::array<SE3, 3>& z) const;
};
using SmoothMotionFactor = PoseFactor<SmoothMotionModel, 3>;

/// Noise of a smooth motion factor. White noise on acceleration of density q makes the mean velocities of two adjacent
/// intervals differ by q (dt1 + dt2) / 3, but each difference is correlated with the next (1/4).
/// An independent q (dt1 + dt2) / 2 has the right variance over many intervals.
PoseNoise smoothMotionNoise(const AccelerationNoise& acceleration, double dt_before_s, double dt_after_s);

}  // namespace motorcade
