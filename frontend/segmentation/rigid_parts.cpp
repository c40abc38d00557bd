#include "frontend/segmentation/rigid_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/LU>

namespace motorcade {
namespace {

constexpr int kPoolingIterations = 3;    // from the median to the weighted mean: the weights hardly change after two
constexpr double kNoInformation = 1e-6;  // keeps sums of information regular [s^2/m^2]

constexpr double kGap_m = 1.5;           // in depth: limbs of a person, which move apart, are nearer
constexpr std::size_t kLeastPoints = 2;  // of a part
constexpr double kSlack_mps = 0.2;       // by which parts of one body seem to close in: they are no corners in space
constexpr double kSigmas = 4.5;          // of the speed at which two bodies surely close in or part
constexpr double kMostChi2 = 11.3;       // of a point's velocity in its part, 3 degrees of freedom: 99 %

Eigen::Vector3d centroidOf(std::span<const int> members, const std::vector<ScenePoint>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int i : members) sum += points[i].flow->p_cam;
  return sum / static_cast<double>(members.size());
}

/// Speed at which two parts close in or part, in standard deviations.
double departure(std::span<const int> nearer, std::span<const int> farther, const std::vector<ScenePoint>& points) {
  const Eigen::Vector3d line = (centroidOf(farther, points) - centroidOf(nearer, points)).normalized();
  const PooledVelocity a = poolVelocities(nearer, points, kMostChi2), b = poolVelocities(farther, points, kMostChi2);
  const double variance = line.dot((a.covariance + b.covariance) * line) + kSlack_mps * kSlack_mps;
  return std::abs(line.dot(b.velocity_mps - a.velocity_mps)) / std::sqrt(variance);
}

/// Number of the nearest points that surely are another body than those beyond, by the clearest of all gaps in depth.
std::optional<std::size_t> clearestCut(std::span<const int> by_depth, const std::vector<ScenePoint>& points) {
  std::optional<std::size_t> cut;
  double most = kSigmas;
  for (std::size_t i = kLeastPoints; i + kLeastPoints <= by_depth.size(); ++i) {
    if (points[by_depth[i]].flow->p_cam.z() - points[by_depth[i - 1]].flow->p_cam.z() < kGap_m) continue;
    const double sigmas = departure(by_depth.first(i), by_depth.subspan(i), points);
    if (sigmas > most) most = sigmas, cut = i;
  }
  return cut;
}

}  // namespace

Eigen::Matrix3d velocityCovariance(const ScenePoint& point) { return point.flow->covariance.bottomRightCorner<3, 3>(); }

PooledVelocity poolVelocities(std::span<const int> members, const std::vector<ScenePoint>& points, double max_chi2) {
  Eigen::Vector3d velocity;
  std::vector<double> values(members.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(members, values.begin(), [&](int i) { return points[i].flow->velocity_mps[axis]; });
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    velocity[axis] = *middle;
  }
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (int iteration = 0; iteration < kPoolingIterations; ++iteration) {
    information = Eigen::Matrix3d::Identity() * kNoInformation;
    Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
    for (const int i : members) {
      const Eigen::Matrix3d W = velocityCovariance(points[i]).inverse();
      const Eigen::Vector3d difference = points[i].flow->velocity_mps - velocity;
      const double chi2 = difference.dot(W * difference), weight = chi2 < max_chi2 ? 1.0 : max_chi2 / chi2;
      information += weight * W;
      weighted += weight * W * points[i].flow->velocity_mps;
    }
    velocity = information.inverse() * weighted;
  }
  return {velocity, information.inverse()};
}

std::vector<std::vector<int>> rigidParts(std::span<const int> members, const std::vector<ScenePoint>& points) {
  std::vector<int> by_depth(members.begin(), members.end());
  std::ranges::stable_sort(by_depth, {}, [&](int i) { return points[i].flow->p_cam.z(); });
  std::vector<std::span<const int>> to_do{by_depth};
  std::vector<std::vector<int>> parts;
  while (!to_do.empty()) {
    const std::span<const int> part = to_do.back();
    to_do.pop_back();
    if (const auto cut = clearestCut(part, points)) {
      to_do.push_back(part.first(*cut));
      to_do.push_back(part.subspan(*cut));
    } else {
      parts.emplace_back(part.begin(), part.end());
      std::ranges::sort(parts.back());
    }
  }
  return parts;
}

}  // namespace motorcade
