#include "frontend/motion/ground_plane.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

constexpr double kMaxDepth_m = 30, kMaxSide_m = 10;  // where roads are flat and a height is known to centimeters
constexpr double kMinHeightShare = 0.5;              // of the camera's height: points above it lie on no road
constexpr double kRoughness_m = 0.08;                // of a road around its plane: camber, curbs' feet, ruts
constexpr double kMaxHeightNoise_m = 0.3;            // higher objects are no road, however little their height is known
constexpr int kHypotheses = 60;                      // find a road that carries half of the points but for 1 in 3000
constexpr int kFirstHypotheses = 240;                // and one that carries a third but for 1 in 8000
constexpr int kMinInliers = 15;                      // fewer are a curb or a car's roof as well
constexpr double kMemory = 0.7;  // weight of the plane before: two thirds of a new pitch show within three frames
constexpr double kMinTriangle_m2 = 0.5;  // twice its area: thinner and smaller ones carry no plane
constexpr double kFit = 2.5;             // in tolerances: points nearer to a plane are fitted

std::optional<GroundPlane> planeThrough(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  Eigen::Vector3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (length < kMinTriangle_m2) return std::nullopt;
  normal /= normal.y() < 0 ? -length : length;
  return GroundPlane{normal, normal.dot(a)};
}

/// Weighted least squares of y = (height - n_x x - n_z z) / n_y over the points near a plane.
std::optional<GroundPlane> refine(const std::vector<LowPoint>& points, const GroundPlane& start) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  int inliers = 0;
  for (const auto& c : points) {
    const double tolerance = c.tolerance_m, x = start.heightOf_m(c.p_cam) / tolerance;
    if (std::abs(x) > kFit) continue;
    const Eigen::Vector3d row(c.p_cam.x(), c.p_cam.z(), 1);
    H += row * row.transpose() / (tolerance * tolerance);
    b += row * c.p_cam.y() / (tolerance * tolerance);
    ++inliers;
  }
  if (inliers < kMinInliers) return std::nullopt;
  const Eigen::Vector3d k = H.ldlt().solve(b);  // y = k0 x + k1 z + k2
  if (!k.allFinite()) return std::nullopt;
  const Eigen::Vector3d normal(-k[0], 1, -k[1]);
  return GroundPlane{normal.normalized(), k[2] / normal.norm()};
}

}  // namespace

GroundPlaneEstimator::GroundPlaneEstimator(const Params& params)
    : params_(requireValid(params)), plane_{.height_m = params.initial_height_m}, mounting_(plane_) {}

bool GroundPlaneEstimator::plausible(const GroundPlane& plane) const {
  return plane.height_m > params_.min_height_m && plane.height_m < params_.max_height_m &&
         plane.normal_cam.y() > cosine(params_.max_tilt_rad);
}

double GroundPlaneEstimator::heightSigma_m(const GroundCandidate& point) const {
  return std::abs(plane_.normal_cam.dot(point.p_cam)) * point.depth_ratio;
}

GroundPlane GroundPlaneEstimator::operator()(std::span<const GroundCandidate> points, std::uint64_t seed) {
  const Hypotheses near_mounting = hypothesesBelow(mounting_.plane(), points, seed);
  if (const auto alone =
          mounting_.isKnown() ? fitted(near_mounting, near_mounting.supports) : fittedAnywhere(points, seed))
    mounting_.add(*alone);
  std::vector<double> scores = near_mounting.supports;
  for (std::size_t i = 0; i < scores.size(); ++i)
    scores[i] = std::max(0.0, scores[i]) * mounting_.likelihoodOf(near_mounting.planes[i]);
  const auto plane = fitted(near_mounting, scores);
  if (!plane) return plane_;
  plane_.normal_cam = (kMemory * plane_.normal_cam + (1 - kMemory) * plane->normal_cam).normalized();
  plane_.height_m = kMemory * plane_.height_m + (1 - kMemory) * plane->height_m;
  return plane_;
}

/// The plane with most support, of all that the camera may look at: it may look down steeply.
std::optional<GroundPlane> GroundPlaneEstimator::fittedAnywhere(std::span<const GroundCandidate> points,
                                                                std::uint64_t seed) const {
  const GroundPlane steepest{{0, cosine(params_.max_tilt_rad), sine(params_.max_tilt_rad)}, params_.min_height_m};
  const Hypotheses anywhere = hypothesesBelow(steepest, points, seed);
  return fitted(anywhere, anywhere.supports);
}

/// The plane with the best score, fitted to its points; empty if that is no road.
std::optional<GroundPlane> GroundPlaneEstimator::fitted(const Hypotheses& hypotheses,
                                                        const std::vector<double>& scores) const {
  if (scores.empty()) return std::nullopt;
  const auto best = std::ranges::max_element(scores) - scores.begin();
  auto plane = refine(hypotheses.low, hypotheses.planes[static_cast<std::size_t>(best)]);
  if (plane && !plausible(*plane)) plane.reset();
  return plane;
}

/// Random planes, the last one and the mounting's, among the points whose height above `road` is less than half of the
/// camera's. None if these points are too few.
GroundPlaneEstimator::Hypotheses GroundPlaneEstimator::hypothesesBelow(GroundPlane road,
                                                                       std::span<const GroundCandidate> points,
                                                                       std::uint64_t seed) const {
  road.height_m *= kMinHeightShare;
  Hypotheses found;
  for (const auto& c : points) {
    const bool near = c.p_cam.z() < kMaxDepth_m && std::abs(c.p_cam.x()) < kMaxSide_m;
    if (near && road.heightOf_m(c.p_cam) < 0)
      found.low.push_back({c.p_cam, hypotenuse(kRoughness_m, heightSigma_m(c))});
  }
  if (static_cast<int>(found.low.size()) < kMinInliers) return found;
  found.planes = {plane_, mounting_.plane()};
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, found.low.size() - 1);
  const auto any = [&] { return found.low[pick(random)].p_cam; };
  const int count = mounting_.isKnown() ? kHypotheses : kFirstHypotheses;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d first = any(), second = any(), third = any();
    const auto plane = planeThrough(first, second, third);
    if (plane && plausible(*plane)) found.planes.push_back(*plane);
  }
  found.supports = planeSupports(found.planes, found.low);
  return found;
}

bool GroundPlaneEstimator::isOnGround(const GroundCandidate& point) const {
  const double tolerance_m = kRoughness_m + std::min(kMaxHeightNoise_m, heightSigma_m(point));
  return std::abs(plane_.heightOf_m(point.p_cam)) < tolerance_m;
}

std::vector<Parameter> parametersOf(GroundPlaneEstimator::Params& params) {
  return {numberParameter("initial_height_m", params.initial_height_m, {0.3, 4},
                          "the height of your camera, until the road is seen"),
          numberParameter("min_height_m", params.min_height_m, {0.1, 2},
                          "the lowest that the camera may be above the road"),
          numberParameter("max_height_m", params.max_height_m, {1.5, 10}, "the highest"),
          numberParameter("max_tilt_rad", params.max_tilt_rad, {0.02, 0.8},
                          "how far your camera may be tilted against the road")};
}

}  // namespace motorcade
