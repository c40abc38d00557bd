#include "frontend/segmentation/motion_segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "frontend/geometry/delaunay.hpp"
#include "frontend/motion/shared_velocity_error.hpp"
#include "frontend/segmentation/geometric_constraints.hpp"
#include "frontend/segmentation/rigid_parts.hpp"

namespace motorcade {
namespace {

/// Union-find with path halving.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  /// The smaller root stays, so that a component is named by its first member.
  void join(int i, int j) {
    i = find(i);
    j = find(j);
    if (i < j) at(j) = i;
    if (j < i) at(i) = j;
  }

 private:
  int& at(int i) { return parent_[i]; }
  std::vector<int> parent_;
};

}  // namespace

std::vector<std::vector<int>> cutDelaunayComponents(std::span<const Eigen::Vector2d> points_px,
                                                    const std::function<bool(int, int)>& belong_together) {
  const auto n = static_cast<int>(points_px.size());
  DisjointSets sets(points_px.size());
  const DelaunayGraph graph = delaunay(points_px, false);
  for (int i = 0; i < n; ++i) sets.join(i, graph.vertex_of_point[i]);
  for (const auto& [i, j] : graph.edges)
    if (sets.find(i) != sets.find(j) && belong_together(i, j)) sets.join(i, j);

  std::vector<std::vector<int>> members(points_px.size());
  for (int i = 0; i < n; ++i) members[sets.find(i)].push_back(i);
  std::erase_if(members, [](const auto& m) { return m.empty(); });
  return members;
}

namespace {

// Differences of velocities on one body that the points' covariances do not explain.
constexpr double kSpeedTolerance_mps = 0.2;  // errors of the model: acceleration, points that are no corners in space
constexpr double kMaxTurnRate_radps = 0.4;   // of a car in a tight turn: at 10 m/s it accelerates aside by 4 m/s^2
constexpr double kMaxSpeedSigma_mps = 4.0;   // points less certain than this are no vertices: they would join anything

// Share of the tolerances and of the largest gap within which two points may be on one vehicle: first all of it, and
// half where that joins several.
constexpr double kWhole = 1, kHalved = 0.5;

constexpr double kStaticSigma_mps = 1.0;  // a component is static when its velocity is known this well
constexpr double kMaxHeight_m = 2.5;      // of its lowest point above the road: what is all higher is leaves and signs
constexpr double kMaxVerticalRatio = 0.35;  // vertical part of a vehicle's velocity: roads are less steep
constexpr double kNoiseSigmas = 2;          // of room for noise where a size or a speed is compared with a bound

Eigen::Matrix3d positionCovariance(const ScenePoint& p) { return p.flow->covariance.topLeftCorner<3, 3>(); }

/// Speed in standard deviations: the Mahalanobis distance from rest.
double significanceOf(const MotionComponent& component) {
  const Eigen::Vector3d& v = component.velocity_mps;
  return std::sqrt(v.dot(component.velocity_covariance.inverse() * v));
}

}  // namespace

bool MotionSegmenter::isVertex(const ScenePoint& point) const {
  if (!point.flow || point.ambiguous || point.label == PointLabel::kGround) return false;
  return std::sqrt(velocityCovariance(point).trace()) < kMaxSpeedSigma_mps;
}

bool MotionSegmenter::belongTogether(const ScenePoint& a, const ScenePoint& b, double slack) const {
  const Eigen::Vector3d dv = a.flow->velocity_mps - b.flow->velocity_mps, dp = a.flow->p_cam - b.flow->p_cam;
  const double distance = dp.norm(), gap_m = slack * params_.max_gap_m,
               tolerance_mps = slack * (kSpeedTolerance_mps + kMaxTurnRate_radps * std::min(distance, gap_m));
  Eigen::Matrix3d C = velocityCovariance(a) + velocityCovariance(b);
  C.diagonal().array() += tolerance_mps * tolerance_mps;
  if (dv.dot(C.inverse() * dv) > params_.max_flow_chi2) return false;
  if (distance < gap_m) return true;
  const Eigen::Vector3d direction = dp / distance;
  const double sigma_m = std::sqrt(direction.dot((positionCovariance(a) + positionCovariance(b)) * direction));
  return distance < gap_m + slack * kNoiseSigmas * sigma_m;
}

std::vector<MotionComponent> MotionSegmenter::operator()(std::vector<ScenePoint>& points,
                                                         const std::vector<bool>& violates_geometry,
                                                         const GroundPlane& ground, double camera_speed_mps) const {
  const Scene scene{points, ground, camera_speed_mps};
  std::vector<int> vertices;
  for (int i = 0; i < static_cast<int>(points.size()); ++i)
    if (isVertex(points[i])) vertices.push_back(i);
  std::vector<MotionComponent> components = split(scene, vertices, [&](int i, int j, double slack) {
    return violates_geometry[i] == violates_geometry[j] && belongTogether(points[i], points[j], slack);
  });
  const auto settled = [&](int i) {
    return points[i].label != PointLabel::kStatic || !movesSurely(camera_, *points[i].flow, camera_speed_mps);
  };
  std::erase_if(vertices, settled);
  const auto alike = [&](int i, int j, double slack) { return belongTogether(points[i], points[j], slack); };
  std::ranges::move(split(scene, vertices, alike), std::back_inserter(components));
  return components;
}

/// Labels the components of these vertices, and returns those that are not static.
std::vector<MotionComponent> MotionSegmenter::split(const Scene& scene, std::span<const int> vertices,
                                                    const Bond& belong_together, double slack) const {
  std::vector<Eigen::Vector2d> pixels;
  for (const int i : vertices) pixels.emplace_back(scene.points[i].uvd_px.head<2>());
  std::vector<MotionComponent> components;
  const auto together = [&](int a, int b) { return belong_together(vertices[a], vertices[b], slack); };
  for (auto& members : cutDelaunayComponents(pixels, together)) {
    for (int& i : members) i = vertices[i];
    MotionComponent component = describe(scene, std::move(members));
    if (const auto parts = partsToSplit(component, scene.points, slack); !parts.empty()) {
      for (const std::vector<int>& part : parts)
        std::ranges::move(split(scene, part, belong_together, kHalved), std::back_inserter(components));
      continue;
    }
    for (const int i : component.points) scene.points[i].label = component.label;
    if (component.label != PointLabel::kStatic) components.push_back(std::move(component));
  }
  return components;
}

/// Parts of a component that holds several bodies: all of it for a queue, else those that do not move as one. Empty for
/// one body.
std::vector<std::vector<int>> MotionSegmenter::partsToSplit(const MotionComponent& component,
                                                            const std::vector<ScenePoint>& points, double slack) const {
  if (slack == kWhole && isQueue(component, points)) return {component.points};
  if (component.label != PointLabel::kMoving) return {};
  std::vector<std::vector<int>> parts = rigidParts(component.points, points);
  if (parts.size() == 1) parts.clear();
  return parts;
}

MotionComponent MotionSegmenter::describe(const Scene& scene, std::vector<int> members) const {
  const std::vector<ScenePoint>& points = scene.points;
  MotionComponent component;
  component.points = std::move(members);
  for (const int i : component.points)
    component.centroid_cam += points[i].flow->p_cam / static_cast<double>(component.points.size());
  const auto pooled = poolVelocities(component.points, points, params_.max_flow_chi2);
  component.velocity_mps = pooled.velocity_mps;
  component.velocity_covariance =
      pooled.covariance + sharedVelocityCovariance(camera_, component.centroid_cam, scene.camera_speed_mps);
  component.label = decide(component, points, scene.ground);
  return component;
}

PointLabel MotionSegmenter::decide(const MotionComponent& component, const std::vector<ScenePoint>& points,
                                   const GroundPlane& ground) const {
  if (static_cast<int>(component.points.size()) < params_.min_points) return PointLabel::kUnknown;
  const Eigen::Vector3d& v = component.velocity_mps;
  const double speed_sigma = std::sqrt(component.velocity_covariance.trace());
  if (significanceOf(component) < params_.min_significance || v.norm() < params_.min_speed_mps)
    return speed_sigma < kStaticSigma_mps ? PointLabel::kStatic : PointLabel::kUnknown;
  return isLikeAVehicle(component, points, ground) ? PointLabel::kMoving : PointLabel::kUnknown;
}

/// True for vehicles that are one component although they move apart: those in a queue or abreast of one another,
/// nearer than the largest gap on one. It must move far more surely than a vehicle: houses may seem to move when
/// calibration or odometry are wrong, and half of a house is no vehicle.
bool MotionSegmenter::isQueue(const MotionComponent& component, const std::vector<ScenePoint>& points) const {
  constexpr double kMoreSurely = 4;
  return component.label == PointLabel::kUnknown && isTooLarge(component, points) &&
         significanceOf(component) > kMoreSurely * params_.min_significance;
}

/// True when it is not too long, not up in the air, and not going up or down.
bool MotionSegmenter::isLikeAVehicle(const MotionComponent& component, const std::vector<ScenePoint>& points,
                                     const GroundPlane& ground) const {
  double lowest_m = std::numeric_limits<double>::infinity();
  for (const int i : component.points) lowest_m = std::min(lowest_m, ground.heightOf_m(points[i].flow->p_cam));
  const Eigen::Vector3d& v = component.velocity_mps;
  const double vertical_mps = std::abs(v.dot(ground.normal_cam));
  const double vertical_sigma = std::sqrt(ground.normal_cam.dot(component.velocity_covariance * ground.normal_cam));
  return !isTooLarge(component, points) && lowest_m < kMaxHeight_m &&
         vertical_mps < kMaxVerticalRatio * v.norm() + kNoiseSigmas * vertical_sigma;
}

bool MotionSegmenter::isTooLarge(const MotionComponent& component, const std::vector<ScenePoint>& points) const {
  Eigen::AlignedBox3d box;
  for (const int i : component.points) box.extend(points[i].flow->p_cam);
  const double depth_noise_m = kNoiseSigmas * std::sqrt(positionCovariance(points[component.points.front()]).trace());
  return box.diagonal().norm() >= params_.max_extent_m + depth_noise_m;
}

std::vector<Parameter> parametersOf(MotionSegmenter::Params& params) {
  return {numberParameter("max_flow_chi2", params.max_flow_chi2, {1, 100},
                          "lower cuts objects apart at smaller differences of their scene flow"),
          numberParameter("max_gap_m", params.max_gap_m, {0.2, 10},
                          "lower parts neighboring vehicles, higher joins sparse ones"),
          numberParameter("min_points", params.min_points, {2, 10},
                          "fewer find smaller and farther objects, more find fewer false ones"),
          numberParameter("min_speed_mps", params.min_speed_mps, {0.1, 10}, "lower finds slower objects"),
          numberParameter("min_significance", params.min_significance, {1, 20},
                          "higher asks for more evidence of motion: fewer false objects, found later"),
          numberParameter("max_extent_m", params.max_extent_m, {3, 40}, "the longest vehicle to expect")};
}

namespace {

/// A point of the component and how far to the side of the travel it lies.
struct Abreast {
  int point;
  double aside_m;
};

constexpr std::size_t kStrays = 20;      // of so many points the outermost one, on each side, may belong elsewhere
constexpr double kDepthNoiseSigmas = 2;  // of room for noise in the width of a vehicle

const SceneFlow& flowOf(const SceneMotion& scene, int point) { return *scene.points[point].flow; }

MotionComponent piece(const MotionComponent& component, std::span<const Abreast> members, const SceneMotion& scene) {
  MotionComponent vehicle = component;
  vehicle.points.clear();
  vehicle.centroid_cam.setZero();
  for (const Abreast& member : members) {
    vehicle.points.push_back(member.point);
    vehicle.centroid_cam += flowOf(scene, member.point).p_cam / static_cast<double>(members.size());
  }
  std::ranges::sort(vehicle.points);
  return vehicle;
}

/// Width of the members without the strays.
double width_m(std::span<const Abreast> members) {
  const std::size_t strays = members.size() / kStrays;
  return members[members.size() - 1 - strays].aside_m - members[strays].aside_m;
}

std::size_t widestGap(std::span<const Abreast> members) {
  std::size_t widest = 1;
  const auto gap_m = [&](std::size_t i) { return members[i].aside_m - members[i - 1].aside_m; };
  for (std::size_t i = 2; i < members.size(); ++i)
    if (gap_m(i) > gap_m(widest)) widest = i;
  return widest;
}

}  // namespace

std::vector<MotionComponent> splitAbreast(const MotionComponent& component, const std::vector<int>& members,
                                          const SceneMotion& scene, double vehicle_width_m) {
  const Eigen::Vector3d left = scene.ground.normal_cam.cross(component.velocity_mps).normalized();
  std::vector<Abreast> sorted;
  double depth_noise_m = 0;
  for (const int i : members) {
    const SceneFlow& flow = flowOf(scene, i);
    sorted.push_back({i, left.dot(flow.p_cam)});
    depth_noise_m =
        std::max(depth_noise_m, kDepthNoiseSigmas * std::sqrt(flow.covariance.topLeftCorner<3, 3>().trace()));
  }
  std::ranges::stable_sort(sorted, {}, &Abreast::aside_m);

  std::vector<MotionComponent> vehicles;
  std::vector<std::span<const Abreast>> to_do;
  if (!sorted.empty()) to_do.emplace_back(sorted);
  while (!to_do.empty()) {
    const std::span<const Abreast> part = to_do.back();
    to_do.pop_back();
    if (width_m(part) <= vehicle_width_m + depth_noise_m) {
      vehicles.push_back(piece(component, part, scene));
      continue;
    }
    const std::size_t cut = widestGap(part);
    to_do.push_back(part.subspan(cut));
    to_do.push_back(part.first(cut));
  }
  return vehicles;
}

}  // namespace motorcade
