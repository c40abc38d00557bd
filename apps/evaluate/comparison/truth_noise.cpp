#include "apps/evaluate/comparison/truth_noise.hpp"

#include <algorithm>
#include <numbers>

#include "core/messages.hpp"

namespace motorcade {
namespace {

constexpr double kGyroscopes_rad = 0.01 * std::numbers::pi / 180;  // of KITTI's inertial unit over some frames

/// Errors of the motions over `frames`.
std::vector<Vector6d> motionErrors(const std::vector<SE3>& estimate, const std::vector<SE3>& truth,
                                   std::size_t frames) {
  std::vector<Vector6d> errors;
  for (std::size_t now = frames; now < std::min(estimate.size(), truth.size()); ++now) {
    const SE3 estimated = estimate[now - frames].inverse() * estimate[now];
    errors.push_back((estimated.inverse() * truth[now - frames].inverse() * truth[now]).log());
  }
  return errors;
}

}  // namespace

Matrix6d truthNoise(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  Vector6d variance = Vector6d::Zero();
  variance.tail<3>().setConstant(kGyroscopes_rad * kGyroscopes_rad);
  const std::vector<Vector6d> errors = motionErrors(estimate, truth, 1);
  if (errors.size() < 2) return variance.asDiagonal();
  Vector6d mean = Vector6d::Zero(), successive = Vector6d::Zero();
  for (const Vector6d& error : errors) mean += error / static_cast<double>(errors.size());
  for (std::size_t i = 1; i < errors.size(); ++i)
    successive += (errors[i] - mean).cwiseProduct(errors[i - 1] - mean) / static_cast<double>(errors.size() - 1);
  variance += 2 * (-successive).cwiseMax(0);
  return variance.asDiagonal();
}

Eigen::Matrix3d placeNoise(const std::vector<SE3>& by_position, const std::vector<SE3>& by_velocity) {
  const auto differences = motionErrors(by_position, by_velocity, kCameraCovarianceFrames);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const Vector6d& difference : differences)
    squares += difference.head<3>().cwiseAbs2() / static_cast<double>(differences.size());
  return squares.asDiagonal();
}

}  // namespace motorcade
