#include "apps/evaluate/comparison/mounting.hpp"

#include <numbers>

#include <Eigen/Cholesky>

#include "core/decompositions.hpp"

namespace motorcade {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
/// Sigma of a step between frames, truth and estimate together. Inertial units jitter by about this much.
constexpr double kStepSigma_m = 0.02, kStepSigma_rad = 0.03 * kRadPerDeg;
/// Sigma of the estimated position. Visual odometry drifts by about a hundredth of the path; the constant is the first
/// pose's noise.
constexpr double kPathSigmaPerWay = 0.01, kPathSigma_m = 0.1;
/// Sigma of the prior. It is wide, as the lever arm also absorbs other errors that grow with turning, such as a lag of
/// the truth.
constexpr double kPriorSigma_m = 1, kPriorSigma_rad = 2 * kRadPerDeg;
constexpr int kMostRounds = 20;
constexpr double kConverged = 1e-10;  // m and rad

/// The same motion by estimate and truth, and the weight of their difference.
struct MotionPair {
  SE3 estimated, true_motion;
  Vector6d weight;  // inverse variances
};

Vector6d weightOf(double sigma_m, double sigma_rad) {
  Vector6d weight;
  weight << Eigen::Vector3d::Constant(1 / (sigma_m * sigma_m)), Eigen::Vector3d::Constant(1 / (sigma_rad * sigma_rad));
  return weight;
}

std::vector<MotionPair> motionPairs(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  std::vector<MotionPair> pairs;
  double way_m = 0;
  // The positions' errors are one drift, seen repeatedly: all of them together count as one.
  const double share = 1 / static_cast<double>(truth.size());
  for (std::size_t k = 1; k < truth.size(); ++k) {
    const SE3 step = truth[k - 1].inverse() * truth[k];
    pairs.push_back({estimate[k - 1].inverse() * estimate[k], step, weightOf(kStepSigma_m, kStepSigma_rad)});
    way_m += step.translation().norm();
    Vector6d positions_only = share * weightOf(kPathSigma_m + kPathSigmaPerWay * way_m, 1);
    positions_only.tail<3>().setZero();
    pairs.push_back({estimate[0].inverse() * estimate[k], truth[0].inverse() * truth[k], positions_only});
  }
  return pairs;
}

/// The Gauss-Newton step on the right of X.
Vector6d stepFrom(const SE3& X, const std::vector<MotionPair>& pairs) {
  const Vector6d prior = weightOf(kPriorSigma_m, kPriorSigma_rad), distance = X.log();
  const Matrix6d J_prior = rightJacobianInverseSE3(distance);
  Matrix6d H = J_prior.transpose() * prior.asDiagonal() * J_prior;
  Vector6d gradient = J_prior.transpose() * prior.cwiseProduct(distance);
  for (const auto& pair : pairs) {
    const SE3 A = X.inverse() * pair.true_motion.inverse() * X * pair.estimated;
    const Vector6d residual = A.log();
    // A(X exp(xi)) = A exp(-Ad(A^-1) xi) exp(Ad(C^-1) xi), with C the estimated motion.
    const Matrix6d J = rightJacobianInverseSE3(residual) * (pair.estimated.inverse().adjoint() - A.inverse().adjoint());
    H += J.transpose() * pair.weight.asDiagonal() * J;
    gradient += J.transpose() * pair.weight.cwiseProduct(residual);
  }
  return -Eigen::LLT<Matrix6d>(H).solve(gradient);
}

}  // namespace

SE3 fitMounting(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  SE3 X;
  const auto pairs = motionPairs(estimate, truth);
  for (int round = 0; round < kMostRounds; ++round) {
    const Vector6d step = stepFrom(X, pairs);
    X = (X * SE3::exp(step)).normalized();
    if (step.norm() < kConverged) break;
  }
  return X;
}

std::vector<SE3> withMounting(const std::vector<SE3>& truth, const SE3& T_true_cam) {
  std::vector<SE3> mounted;
  mounted.reserve(truth.size());
  for (const auto& T_world_true : truth) mounted.push_back(T_world_true * T_true_cam);
  return mounted;
}

}  // namespace motorcade
