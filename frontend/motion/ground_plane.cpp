#include "frontend/motion/ground_plane.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace motorcade {
namespace {

/// A point that may lie on the road.
struct LowPoint {
  Eigen::Vector3d p_cam;
  double tolerance_m;  // of its height above the plane
};

std::optional<GroundPlane> planeThrough(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  Eigen::Vector3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (length < 0.5) return std::nullopt;  // nearly collinear, or too close together to carry a plane [m^2]
  normal /= normal.y() < 0 ? -length : length;
  return GroundPlane{normal, normal.dot(a)};
}

/// Truncated quadratic score: the larger the better. Planes with many points above them lie too low and are no roads:
/// a point below a plane (seen through it) counts against it.
double support(const std::vector<LowPoint>& points, const GroundPlane& plane) {
  double sum = 0;
  for (const auto& c : points) {
    const double x = plane.heightOf_m(c.p_cam) / c.tolerance_m;
    if (std::abs(x) < 3) sum += 1 - x * x / 9;
    if (x < -4) sum -= 0.5;
  }
  return sum;
}

/// Weighted least squares of y = (height - n_x x - n_z z) / n_y over the points near a plane.
std::optional<GroundPlane> refine(const std::vector<LowPoint>& points, const GroundPlane& start, int min_inliers) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  int inliers = 0;
  for (const auto& c : points) {
    const double tolerance = c.tolerance_m, x = start.heightOf_m(c.p_cam) / tolerance;
    if (std::abs(x) > 2.5) continue;
    const Eigen::Vector3d row(c.p_cam.x(), c.p_cam.z(), 1);
    H += row * row.transpose() / (tolerance * tolerance);
    b += row * c.p_cam.y() / (tolerance * tolerance);
    ++inliers;
  }
  if (inliers < min_inliers) return std::nullopt;
  const Eigen::Vector3d k = H.ldlt().solve(b);  // y = k0 x + k1 z + k2
  if (!k.allFinite()) return std::nullopt;
  const Eigen::Vector3d normal(-k[0], 1, -k[1]);
  return GroundPlane{normal.normalized(), k[2] / normal.norm()};
}

}  // namespace

GroundPlaneEstimator::GroundPlaneEstimator(const Params& params) : params_(requireValid(params)) {
  plane_.height_m = params.initial_height_m;
}

bool GroundPlaneEstimator::plausible(const GroundPlane& plane) const {
  return plane.height_m > params_.min_height_m && plane.height_m < params_.max_height_m &&
         plane.normal_cam.y() > std::cos(params_.max_tilt_rad);
}

GroundPlane GroundPlaneEstimator::operator()(std::span<const GroundCandidate> points, std::uint64_t seed) {
  std::vector<LowPoint> low;
  for (const auto& c : points) {
    const bool near = c.p_cam.z() < params_.max_depth_m && std::abs(c.p_cam.x()) < params_.max_side_m;
    if (near && c.p_cam.y() > 0.5 * params_.min_height_m)
      low.push_back({c.p_cam, std::hypot(params_.inlier_m, c.height_sigma_m)});
  }
  if (static_cast<int>(low.size()) < params_.min_inliers) return plane_;

  GroundPlane best = plane_;
  double best_support = support(low, best);
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, low.size() - 1);
  for (int k = 0; k < params_.hypotheses; ++k) {
    const auto plane = planeThrough(low[pick(random)].p_cam, low[pick(random)].p_cam, low[pick(random)].p_cam);
    if (!plane || !plausible(*plane)) continue;
    const double s = support(low, *plane);
    if (s > best_support) {
      best_support = s;
      best = *plane;
    }
  }
  const auto refined = refine(low, best, params_.min_inliers);
  if (!refined || !plausible(*refined)) return plane_;
  const double m = params_.memory;
  plane_.normal_cam = (m * plane_.normal_cam + (1 - m) * refined->normal_cam).normalized();
  plane_.height_m = m * plane_.height_m + (1 - m) * refined->height_m;
  return plane_;
}

std::vector<Parameter> parametersOf(GroundPlaneEstimator::Params& params) {
  return {numberParameter("initial_height_m", params.initial_height_m, {0.3, 4},
                          "the height of your camera, until the road is seen"),
          numberParameter("min_height_m", params.min_height_m, {0.1, 1.5},
                          "the lowest that the camera may be above the road"),
          numberParameter("max_height_m", params.max_height_m, {1.5, 10}, "the highest"),
          numberParameter("max_tilt_rad", params.max_tilt_rad, {0.02, 0.5},
                          "how far your camera may be tilted against the road")};
}

}  // namespace motorcade
