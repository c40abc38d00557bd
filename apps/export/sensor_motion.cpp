#include "apps/export/sensor_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace motorcade {
namespace {

constexpr double kReach_s = 0.35;
constexpr double kMostNeighbor_s = 1;  // a frame next to another but later than that tells nothing of its motion
constexpr int kUnknowns = 3;

/// The range of frames [first, last) that may count.
struct Range {
  std::size_t first, last;
};

double timeSince(const TimedPose& frame, const TimedPose& other) {
  return secondsBetween(frame.head.stamp, other.head.stamp);
}

Range rangeAround(const std::vector<TimedPose>& way, std::size_t index) {
  const auto near = [&](std::size_t other) { return std::abs(timeSince(way[index], way[other])) <= kReach_s; };
  Range range{.first = index > 0 ? index - 1 : index, .last = std::min(index + 2, way.size())};
  while (range.first > 0 && near(range.first - 1)) --range.first;
  while (range.last < way.size() && near(range.last)) ++range.last;
  return range;
}

bool counts(const TimedPose& here, const TimedPose& other) {
  return other.head.status != FrameStatus::kRejected && other.head.segment == here.head.segment &&
         std::abs(timeSince(here, other)) <= kMostNeighbor_s;
}

constexpr double kStands_mps = 0.1;  // below, the direction of a velocity is noise

/// The center of the cuboid in the world, and its derivatives there. The columns for the body's origin are those of the
/// run folder: a speed along the path, and a turn about the body's z axis.
struct CenterMotion {
  Eigen::Vector3d velocity_mps;
  std::optional<Eigen::Vector3d> acceleration_mps2;
};

CenterMotion centerMotion(const ObjectEstimate& object, const Eigen::Vector3d& center_body) {
  const Eigen::Matrix3d& R = object.T_world_body.rotation();
  const Eigen::Vector3d arm = R * center_body, turn_radps = object.yaw_rate_radps * R.col(2);
  CenterMotion motion{.velocity_mps = object.velocity_world_mps + turn_radps.cross(arm), .acceleration_mps2 = {}};
  if (const auto& told = object.acceleration)
    motion.acceleration_mps2 = told->along_mps2 * directionOf(object) + turn_radps.cross(motion.velocity_mps) +
                               (told->yaw_radps2 * R.col(2)).cross(arm);
  return motion;
}

}  // namespace

std::optional<SensorMotion> sensorMotionAt(const std::vector<TimedPose>& way, std::size_t index) {
  const TimedPose& here = way[index];
  if (here.head.status == FrameStatus::kRejected) return std::nullopt;
  const SE3 T_sensor_world = here.T_world_sensor.inverse();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, kUnknowns, 6> right = Eigen::Matrix<double, kUnknowns, 6>::Zero();
  int count = 0;
  double last_s = -std::numeric_limits<double>::infinity();  // times that do not advance tell nothing
  const auto [first, last] = rangeAround(way, index);
  for (std::size_t i = first; i < last; ++i) {
    const double t_s = timeSince(here, way[i]);
    if (!counts(here, way[i]) || t_s <= last_s) continue;
    last_s = t_s;
    const Eigen::Vector3d row(1, t_s, t_s * t_s / 2);
    information += row * row.transpose();
    right += row * (T_sensor_world * way[i].T_world_sensor).log().transpose();
    ++count;
  }
  if (count < kUnknowns) return std::nullopt;
  const Eigen::Matrix<double, kUnknowns, 6> fit = information.ldlt().solve(right);
  return SensorMotion{.twist = fit.row(1).transpose(), .change = fit.row(2).transpose()};
}

Eigen::Vector3d directionOf(const ObjectEstimate& object) {
  const double speed_mps = object.velocity_world_mps.norm();
  if (speed_mps < kStands_mps) return object.T_world_body.rotation().col(0);
  return object.velocity_world_mps / speed_mps;
}

RelativeMotion relativeMotion(const ObjectEstimate& object, const SE3& T_sensor_world, const SensorMotion& sensor) {
  const Eigen::Vector3d center_body = object.cuboid ? object.cuboid->center_body : Eigen::Vector3d::Zero();
  const SE3 T_body_box(Eigen::Matrix3d::Identity(), center_body);
  const Eigen::Matrix3d& R_sensor_world = T_sensor_world.rotation();
  const CenterMotion center = centerMotion(object, center_body);
  RelativeMotion motion{.T_sensor_box = T_sensor_world * object.T_world_body * T_body_box};
  const Eigen::Vector3d& p = motion.T_sensor_box.translation();
  const Eigen::Vector3d v = sensor.twist.head<3>(), w = sensor.twist.tail<3>();
  const Eigen::Vector3d v_center = R_sensor_world * center.velocity_mps;
  motion.velocity_mps = v_center - v - w.cross(p);
  if (center.acceleration_mps2)
    motion.acceleration_mps2 = R_sensor_world * *center.acceleration_mps2 - w.cross(v_center) -
                               sensor.change.head<3>() - sensor.change.tail<3>().cross(p) -
                               w.cross(motion.velocity_mps);
  motion.turn_radps = object.yaw_rate_radps * Eigen::Vector3d::UnitZ() - motion.T_sensor_box.rotation().transpose() * w;
  return motion;
}

}  // namespace motorcade
