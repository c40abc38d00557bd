#include "apps/evaluate/comparison/truth_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

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
