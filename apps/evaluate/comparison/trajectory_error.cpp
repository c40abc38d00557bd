#include "apps/evaluate/comparison/trajectory_error.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "core/decompositions.hpp"

namespace motorcade {

double angleOf_deg(const Eigen::Matrix3d& rotation) { return logSO3(rotation).norm() * 180 / std::numbers::pi; }

SE3 stepError(const SE3& estimate_before, const SE3& estimate, const SE3& truth_before, const SE3& truth) {
  const SE3 true_step = truth_before.inverse() * truth;
  return true_step.inverse() * (estimate_before.inverse() * estimate);
}

namespace {

/// Quantile of sorted values, interpolated linearly between two of them.
double quantileOf(const std::vector<double>& sorted, double part) {
  const double at = part * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double above = sorted[std::min(below + 1, sorted.size() - 1)];
  return sorted[below] + (at - static_cast<double>(below)) * (above - sorted[below]);
}

/// The rotation that brings the estimated attitudes closest to the true ones in the least-squares (chordal) sense.
Eigen::Matrix3d alignRotations(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < truth.size(); ++i) sum += truth[i].rotation() * estimate[i].rotation().transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double side = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Eigen::Vector3d(1, 1, side).asDiagonal() * svd.matrixV().transpose();
}

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

constexpr std::size_t kFramesBetweenSegments = 10;
constexpr double kLeastForLongSegments_m = 300;  // a shorter path has few segments of 100 m, if any

/// The distance along the path from its first pose to each pose.
std::vector<double> waysAlong(const std::vector<SE3>& path) {
  std::vector<double> ways_m;
  ways_m.reserve(path.size());
  for (std::size_t i = 0; i < path.size(); ++i)
    ways_m.push_back(i == 0 ? 0 : ways_m.back() + (path[i].translation() - path[i - 1].translation()).norm());
  return ways_m;
}

/// One segment's share of the sums.
void addSegment(SegmentMeans& sums, const SE3& error, double length_m) {
  constexpr double kPercent = 100;
  ++sums.segments;
  sums.translation_percent += kPercent * error.translation().norm() / length_m;
  sums.rotation_deg_per_m += angleOf_deg(error.rotation()) / length_m;
}

void divideByCount(SegmentMeans& sums) {
  const auto n = static_cast<double>(std::max<std::size_t>(1, sums.segments));
  sums.translation_percent /= n;
  sums.rotation_deg_per_m /= n;
}

}  // namespace

Statistics statisticsOf(std::vector<double> errors) {
  Statistics statistics{.count = errors.size()};
  if (errors.empty()) return statistics;
  double sum = 0, squares = 0;
  for (double& error : errors) {
    error = std::abs(error);
    sum += error;
    squares += error * error;
  }
  const auto n = static_cast<double>(errors.size());
  std::ranges::sort(errors);
  statistics.rmse = std::sqrt(squares / n);
  statistics.mean = sum / n;
  statistics.median = (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]) / 2;
  statistics.p95 = quantileOf(errors, 0.95);
  statistics.max = errors.back();
  return statistics;
}

SE3 alignPositions(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  assert(estimate.size() == truth.size() && !truth.empty());
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(estimate.size())), to(3, from.cols());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = estimate[i].translation();
    to.col(static_cast<Eigen::Index>(i)) = truth[i].translation();
  }
  const Eigen::Matrix4d S = Eigen::umeyama(from, to, false);
  return SE3(S.topLeftCorner<3, 3>(), S.topRightCorner<3, 1>()).normalized();
}

std::optional<TrajectoryErrors> trajectoryErrors(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  assert(estimate.size() == truth.size());
  if (truth.size() < 2) return std::nullopt;
  const SE3 aligned = alignPositions(estimate, truth), at_first = truth.front() * estimate.front().inverse();
  const Eigen::Matrix3d turned = alignRotations(estimate, truth);
  std::vector<double> ate_m, ate_first_m, are_deg, rpe_m, rpe_deg;
  TrajectoryErrors errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const SE3 best = aligned * estimate[i];
    ate_m.push_back((best.translation() - truth[i].translation()).norm());
    are_deg.push_back(angleOf_deg(truth[i].rotation().transpose() * turned * estimate[i].rotation()));
    ate_first_m.push_back((at_first * estimate[i].translation() - truth[i].translation()).norm());
    if (i == 0) continue;
    const SE3 difference = stepError(estimate[i - 1], estimate[i], truth[i - 1], truth[i]);
    rpe_m.push_back(difference.translation().norm());
    rpe_deg.push_back(angleOf_deg(difference.rotation()));
    errors.length_m += (truth[i - 1].inverse() * truth[i]).translation().norm();
  }
  if (errors.length_m > 0) errors.end_percent = 100 * ate_first_m.back() / errors.length_m;
  errors.ate_m = statisticsOf(std::move(ate_m));
  errors.ate_first_pose_m = statisticsOf(std::move(ate_first_m));
  errors.are_deg = statisticsOf(std::move(are_deg));
  errors.rpe_m = statisticsOf(std::move(rpe_m));
  errors.rpe_deg = statisticsOf(std::move(rpe_deg));
  return errors;
}

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

std::optional<SegmentErrors> segmentErrors(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  assert(estimate.size() == truth.size());
  if (truth.empty()) return std::nullopt;
  const std::vector<double> ways_m = waysAlong(truth);
  SegmentErrors errors;
  errors.short_segments = ways_m.back() < kLeastForLongSegments_m;
  for (std::size_t k = 0; k < SegmentErrors::kLengths; ++k) {
    SegmentErrors::OfLength& of_length = errors.by_length[k];
    of_length.length_m = (errors.short_segments ? 10.0 : 100.0) * static_cast<double>(k + 1);
    for (std::size_t first = 0; first < truth.size(); first += kFramesBetweenSegments) {
      const auto last = std::ranges::upper_bound(ways_m, ways_m[first] + of_length.length_m) - ways_m.begin();
      if (last == std::ssize(ways_m)) break;
      const SE3 error = stepError(estimate[first], estimate[last], truth[first], truth[last]);
      addSegment(of_length, error, of_length.length_m);
      addSegment(errors.all, error, of_length.length_m);
    }
    divideByCount(of_length);
  }
  divideByCount(errors.all);
  return errors.all.segments > 0 ? std::optional(errors) : std::nullopt;
}

}  // namespace motorcade
