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

}  // namespace motorcade
