#include "apps/evaluate/comparison/truth_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"

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

constexpr double kChord_m = 5;
constexpr double kWayDiffers_percent = 1, kDiffers_m = 1;

/// Truth from velocities; empty if the packets cannot be used, as usable poses are measured all the same.
std::optional<CameraTruth> velocityTruth(const Sequence& sequence) {
  try {
    return readCameraTruth(sequence, OxtsTimes::kVelocities);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

Eigen::Vector3d motionOf(const std::vector<SE3>& path, std::size_t from, std::size_t to) {
  return (path[from].inverse() * path[to]).translation();
}

/// Compares the motions between two frames.
void addChord(TruthCheck& check, const Eigen::Vector3d& told, const Eigen::Vector3d& by_velocity, FrameId from,
              FrameId to) {
  check.way_m += told.norm();
  check.velocity_way_m += by_velocity.norm();
  const double step_m = (told - by_velocity).norm();
  if (step_m <= check.largest_step_m) return;
  check.largest_step_m = step_m;
  check.step_from = from;
  check.step_to = to;
}

/// Its length is at most one; near zero where the path has no main direction.
Eigen::Vector3d meanCourse(const std::vector<SE3>& path) {
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  double way_m = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector3d step_m = motionOf(path, i - 1, i);
    sum_m += step_m;
    way_m += step_m.norm();
  }
  return sum_m / std::max(way_m, 1e-9);
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

double TruthCheck::differencePercent() const { return way_m > 0 ? 100 * (velocity_way_m - way_m) / way_m : 0; }

bool TruthCheck::waysDiffer() const {
  return std::abs(velocity_way_m - way_m) > kDiffers_m && std::abs(differencePercent()) > kWayDiffers_percent;
}

bool TruthCheck::jumps() const { return largest_step_m > kDiffers_m; }

std::optional<TruthCheck> checkTruth(const Sequence& sequence, const CameraTruth& truth) {
  const auto velocities = velocityTruth(sequence);
  if (!velocities) return std::nullopt;
  const auto &told = truth.T_world_cam, &by_velocity = velocities->T_world_cam;
  const std::size_t end = std::min(told.size(), by_velocity.size());
  TruthCheck check;
  auto from = static_cast<std::size_t>(truth.first_frame);
  for (std::size_t to = from + 1; to < end; ++to) {
    const Eigen::Vector3d motion = motionOf(by_velocity, from, to);
    if (motion.norm() < kChord_m && to + 1 < end) continue;
    addChord(check, motionOf(told, from, to), motion, {static_cast<std::int64_t>(from)},
             {static_cast<std::int64_t>(to)});
    from = to;
  }
  return check;
}

double courseDifference_deg(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  constexpr double kLeastOfWay = 0.5;
  const Eigen::Vector3d ours = meanCourse(estimate), theirs = meanCourse(truth);
  if (ours.norm() < kLeastOfWay || theirs.norm() < kLeastOfWay) return 0;
  return std::atan2(ours.cross(theirs).norm(), ours.dot(theirs)) * 180 / std::numbers::pi;
}

}  // namespace motorcade
