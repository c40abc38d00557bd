#include "apps/evaluate/comparison/trajectory_error.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

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

namespace {

/// The rotation that brings the estimated attitudes closest to the true ones in the least-squares (chordal) sense.
Eigen::Matrix3d alignRotations(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < truth.size(); ++i) sum += truth[i].rotation() * estimate[i].rotation().transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double side = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Eigen::Vector3d(1, 1, side).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

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

}  // namespace motorcade
