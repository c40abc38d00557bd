#include "frontend/segmentation/vehicles_abreast.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Geometry>

namespace motorcade {
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
