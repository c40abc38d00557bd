#include "apps/evaluate/measures/consistency.hpp"

#include <algorithm>

#include <Eigen/LU>

#include "apps/evaluate/comparison/object_positions.hpp"
#include "core/decompositions.hpp"

namespace motorcade {
namespace {

constexpr double kChiSquare95Of6 = 12.591587, kChiSquare95Of3 = 7.814728;  // 95 % quantiles

NormalizedErrors normalizedErrors(const std::vector<double>& nees, double region) {
  const auto n = static_cast<double>(nees.size());
  const Statistics statistics = statisticsOf(nees);
  return {.mean_nees = statistics.mean,
          .median_nees = statistics.median,
          .coverage_95 =
              n > 0
                  ? static_cast<double>(std::ranges::count_if(nees, [&](double value) { return value <= region; })) / n
                  : 0};
}

double neesOf(const Eigen::Vector3d& xi, const Eigen::Matrix3d& covariance) {
  return xi.dot(covariance.inverse() * xi);
}

ErrorSample errorOf(const SeenTwice& seen, const SE3& Y) {
  const Matrix6d carried = Y.inverse().adjoint();
  return {(seen.T_cam_body.inverse() * seen.T_cam_other * Y).log(),
          seen.covariance + carried * seen.other_covariance * carried.transpose()};
}

/// The Gauss-Newton step on the right of Y.
Vector6d stepFrom(const SE3& Y, const std::vector<SeenTwice>& frames) {
  Matrix6d H = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (const auto& seen : frames) {
    const ErrorSample error = errorOf(seen, Y);
    const Eigen::LLT<Matrix6d> cholesky(error.covariance);
    if (cholesky.info() != Eigen::Success) continue;
    const Matrix6d J = rightJacobianInverseSE3(error.xi);
    H += J.transpose() * cholesky.solve(J);
    gradient += J.transpose() * cholesky.solve(error.xi);
  }
  const Eigen::LLT<Matrix6d> cholesky(H);
  return cholesky.info() == Eigen::Success ? Vector6d(-cholesky.solve(gradient)) : Vector6d::Zero();
}

SE3 fitOffset(const std::vector<SeenTwice>& frames) {
  constexpr int kRounds = 10;  // from the mean, which is close
  std::vector<SE3> bodies, others;
  for (const auto& seen : frames) {
    bodies.push_back(seen.T_cam_body);
    others.push_back(seen.T_cam_other);
  }
  SE3 Y = bodyOffset(others, bodies);
  for (int round = 0; round < kRounds; ++round) Y = (Y * SE3::exp(stepFrom(Y, frames))).normalized();
  return Y;
}

}  // namespace

CovarianceErrors consistencyOf(const std::vector<ErrorSample>& samples) {
  std::vector<double> pose, position, rotation;
  AxisReliability by_axis;
  for (const auto& sample : samples) {
    const Eigen::LLT<Matrix6d> cholesky(sample.covariance);
    if (cholesky.info() != Eigen::Success) continue;
    pose.push_back(sample.xi.dot(cholesky.solve(sample.xi)));
    position.push_back(neesOf(sample.xi.head<3>(), sample.covariance.topLeftCorner<3, 3>()));
    rotation.push_back(neesOf(sample.xi.tail<3>(), sample.covariance.bottomRightCorner<3, 3>()));
    by_axis.add(sample.xi, sample.covariance);
  }
  return {.samples = static_cast<int>(pose.size()),
          .pose = normalizedErrors(pose, kChiSquare95Of6),
          .position = normalizedErrors(position, kChiSquare95Of3),
          .rotation = normalizedErrors(rotation, kChiSquare95Of3),
          .by_axis = by_axis};
}

std::vector<ErrorSample> errorsWithoutOffset(const std::vector<SeenTwice>& frames) {
  const SE3 Y = fitOffset(frames);
  std::vector<ErrorSample> errors;
  for (const auto& seen : frames) errors.push_back(errorOf(seen, Y));
  return errors;
}

}  // namespace motorcade
