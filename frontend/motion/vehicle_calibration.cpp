#include "frontend/motion/vehicle_calibration.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

using Piece = VehicleSamples::Piece;
using Pieces = std::span<const Piece>;
using State = VehicleCalibration::State;

// What is known before the camera has moved: worn and loaded tires, cheap gyroscopes, a camera behind the windscreen
// that looks ahead to a few degrees.
constexpr double kScaleSigma = 0.04, kBiasSigma_radps = 0.01, kTravelSigma_rad = 0.04;
constexpr double kLever_m = 1.5, kLeverSigma_m = 1.0;  // of a camera ahead of the rear axle
// How it drifts, per square root of a second: tires warm up, as gyroscopes do, and loads shift.
constexpr double kScaleDrift = 5e-4, kBiasDrift_radps = 1e-4, kTravelDrift_rad = 2e-4, kLeverDrift_m = 2e-3;

constexpr double kNoiseInterval_s = 0.1;  // errors of samples are alike over so long
constexpr double kFirstSpeedSigma_mps = 0.15, kFirstYawRateSigma_radps = 0.01;
constexpr double kLeastSpeedSigma_mps = 0.02, kLeastYawRateSigma_radps = 0.0005;
constexpr double kNoiseRate = 0.02;                // of the mean over frames that tells the noise: fifty frames
constexpr double kUnknownAcceleration = 1.5;       // m/s^2 between samples that are far apart
constexpr double kUnknownYaw_radps2 = 0.15;        // the same of the yaw rate
constexpr double kSlip = 0.002;                    // of the way: tires creep with every push and brake
constexpr double kNod_m = 0.01, kNodShare = 0.02;  // sideways and upwards in a frame: the body sways on its springs
constexpr double kBump_rad = 0.005, kRoll_rad = 0.008;  // of a car's body on its springs
constexpr double kSlopeWalk = 1.2e-3;                   // change of a road's slope, per square root of a meter
// What makes a difference strange: wheels slip, curves and delays shift it, more at speed.
constexpr double kStrange_mps = 0.15, kStrangeShare = 0.02, kStrange_radps = 0.015;

/// Axes of a camera that looks ahead, z, in those of the vehicle, x.
Eigen::Matrix3d lookingAhead() {
  Eigen::Matrix3d R_vehicle_cam;
  R_vehicle_cam << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R_vehicle_cam;
}

SE3 mountingOf(const State& state) {
  const Eigen::Vector3d turn(0, state[VehicleCalibration::kTravelPitch], state[VehicleCalibration::kTravelYaw]);
  return {expSO3(turn) * lookingAhead(), {state[VehicleCalibration::kLever], 0, 0}};
}

SE3 expectedMotion(Pieces pieces, const State& state) {
  SE3 T_then_now;
  for (const Piece& piece : pieces) {
    Vector6d step = Vector6d::Zero();
    step[0] = state[VehicleCalibration::kScale] * piece.speed_mps * piece.dt_s;
    step[5] = (piece.yaw_rate_radps - state[VehicleCalibration::kBias]) * piece.dt_s;
    T_then_now = T_then_now * SE3::exp(step);
  }
  const SE3 T_vehicle_cam = mountingOf(state);
  return (T_vehicle_cam.inverse() * T_then_now * T_vehicle_cam).normalized();
}

/// Sums over pieces that tell how far errors of the samples go.
struct Sums {
  double time_s = 0, way_m = 0, path_m = 0;         // the way with its sign, and the length of the path
  double along_variance = 0, heading_variance = 0;  // by the samples' noise
};

Sums sumsOf(Pieces pieces, double speed_variance, double yaw_rate_variance) {
  Sums sums;
  for (const Piece& piece : pieces) {
    const double way_m = piece.speed_mps * piece.dt_s;
    sums.time_s += piece.dt_s;
    sums.way_m += way_m;
    sums.path_m += std::abs(way_m);
    const double speed_sigma = std::max(piece.speed_sigma_mps, kUnknownAcceleration * piece.unknown_s);
    const double yaw_rate_sigma = std::max(piece.yaw_rate_sigma_radps, kUnknownYaw_radps2 * piece.unknown_s);
    const double alike_s = piece.dt_s * std::max(kNoiseInterval_s, piece.unknown_s);
    sums.along_variance += alike_s * std::max(speed_variance, speed_sigma * speed_sigma);
    sums.heading_variance += alike_s * std::max(yaw_rate_variance, yaw_rate_sigma * yaw_rate_sigma);
  }
  return sums;
}

double square(double x) { return x * x; }

/// Noise of a motion along the vehicle's axes at its end, beside errors of the state. A heading that walks off carries
/// the place aside by the way / 2 with it, by the way / sqrt(3) in all; so does the slope of a road.
Matrix6d noiseOf(const Sums& sums) {
  const double way_m = sums.way_m, slope = square(kSlopeWalk) * sums.path_m;
  const double heading = sums.heading_variance;
  Matrix6d noise = Matrix6d::Zero();
  noise(0, 0) = sums.along_variance + square(kSlip * sums.path_m) + square(kNod_m);
  noise(1, 1) = square(way_m) * (heading / 3 + square(kBump_rad) / 4) + square(kNod_m);
  noise(2, 2) = square(way_m) * (slope / 3 + square(kBump_rad)) + square(kNod_m);
  noise(3, 3) = square(kRoll_rad) + slope;
  noise(4, 4) = square(kBump_rad) + slope;
  noise(5, 5) = heading + square(kLeastYawRateSigma_radps);
  noise(1, 5) = noise(5, 1) = way_m * heading / 2;
  noise(2, 4) = noise(4, 2) = -way_m * slope / 2;
  return noise;
}

/// Rotation of both halves of a perturbation.
Matrix6d turning(const Eigen::Matrix3d& R) {
  Matrix6d both = Matrix6d::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = R;
  return both;
}

}  // namespace

VehicleCalibration::VehicleCalibration()
    : speed_variance_(square(kFirstSpeedSigma_mps)), yaw_rate_variance_(square(kFirstYawRateSigma_radps)) {
  state_ << 1, 0, 0, 0, kLever_m;
  State sigma;
  sigma << kScaleSigma, kBiasSigma_radps, kTravelSigma_rad, kTravelSigma_rad, kLeverSigma_m;
  covariance_ = sigma.cwiseAbs2().asDiagonal();
}

/// Jacobian of the motion under right perturbation, along the vehicle's axes, by differences, as arcs are many.
VehicleCalibration::StateJacobian VehicleCalibration::jacobian(Pieces pieces, const SE3& T_then_now) const {
  constexpr double kStep = 1e-5;
  const Matrix6d R_vehicle_cam = turning(mountingOf(state_).rotation());
  StateJacobian J;
  for (int k = 0; k < state_.size(); ++k) {
    State moved = state_;
    moved[k] += kStep;
    J.col(k) = R_vehicle_cam * (T_then_now.inverse() * expectedMotion(pieces, moved)).log() / kStep;
  }
  return J;
}

UncertainMotion VehicleCalibration::motionOver(Pieces pieces, double slip_mps) const {
  const SE3 T_then_now = expectedMotion(pieces, state_);
  const StateJacobian J = jacobian(pieces, T_then_now);
  const Matrix6d R_cam_vehicle = turning(mountingOf(state_).rotation().transpose());
  const Sums sums = sumsOf(pieces, speed_variance_, yaw_rate_variance_);
  Matrix6d in_vehicle = J * covariance_ * J.transpose() + noiseOf(sums);
  in_vehicle(0, 0) += square(slip_mps * sums.time_s);
  return {T_then_now, R_cam_vehicle * in_vehicle * R_cam_vehicle.transpose()};
}

VehicleCalibration::Difference VehicleCalibration::difference(Pieces pieces, const SE3& T_then_now) const {
  const SE3 expected = expectedMotion(pieces, state_);
  return {turning(mountingOf(state_).rotation()) * (expected.inverse() * T_then_now).log(), jacobian(pieces, expected),
          sumsOf(pieces, 0, 0).time_s};
}

VehicleCalibration::Surprise VehicleCalibration::compare(Pieces pieces, const UncertainMotion& seen) const {
  const Difference found = difference(pieces, seen.T_then_now);
  const Matrix6d known = found.J * covariance_ * found.J.transpose();
  const double speed_mps = sumsOf(pieces, 0, 0).path_m / found.dt_s;
  const double speed_variance =
      square(kStrange_mps + kStrangeShare * speed_mps) + speed_variance_ + known(0, 0) / square(found.dt_s);
  const double yaw_variance = square(kStrange_radps) + yaw_rate_variance_ + known(5, 5) / square(found.dt_s);
  const double speed_difference_mps = found.seen_less_expected[0] / found.dt_s;
  return {speed_difference_mps, std::abs(speed_difference_mps) / std::sqrt(speed_variance),
          std::abs(found.seen_less_expected[5]) / found.dt_s / std::sqrt(yaw_variance)};
}

/// Learns from the places and the heading; pitch and roll are the springs'.
void VehicleCalibration::learn(Pieces pieces, const UncertainMotion& seen) {
  constexpr int kCompared = 4;
  const Difference found = difference(pieces, seen.T_then_now);
  const Matrix6d R = turning(mountingOf(state_).rotation());
  const Vector6d camera_variance = (R * seen.covariance * R.transpose()).diagonal();
  const Sums sums = sumsOf(pieces, speed_variance_, yaw_rate_variance_);
  const double sway_variance = square(kNod_m) + square(kNodShare * sums.path_m);

  const Eigen::Array<int, kCompared, 1> rows(0, 1, 2, 5);
  Eigen::Vector4d variance;
  variance << square(found.dt_s) * speed_variance_, sway_variance, sway_variance,
      square(found.dt_s) * yaw_rate_variance_;
  const Eigen::Matrix<double, kCompared, 5> H = found.J(rows, Eigen::all);
  const Eigen::Vector4d residual = found.seen_less_expected(rows);
  variance += camera_variance(rows);

  State drift;
  drift << kScaleDrift, kBiasDrift_radps, kTravelDrift_rad, kTravelDrift_rad, kLeverDrift_m;
  covariance_.diagonal() += found.dt_s * drift.cwiseAbs2();
  Eigen::Matrix4d S = H * covariance_ * H.transpose();
  S.diagonal() += variance;
  const Eigen::Matrix<double, 5, kCompared> K = covariance_ * H.transpose() * S.inverse();
  state_ += K * residual;
  covariance_ -= K * S * K.transpose();
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  learnNoise(found, camera_variance);
}

/// Learns the samples' noise: the difference that is not the camera's.
void VehicleCalibration::learnNoise(const Difference& found, const Vector6d& camera_variance) {
  const auto follow = [&](double& variance, int row, double least) {
    const double squared = square(found.seen_less_expected[row]) - camera_variance[row];
    variance = std::max(square(least), variance + kNoiseRate * (squared / square(found.dt_s) - variance));
  };
  follow(speed_variance_, 0, kLeastSpeedSigma_mps);
  follow(yaw_rate_variance_, 5, kLeastYawRateSigma_radps);
}

}  // namespace motorcade
