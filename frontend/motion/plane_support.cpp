#include <vector>

#include "core/instruction_set.hpp"
#include "frontend/motion/ground_plane.hpp"

#define HWY_TARGET_INCLUDE "frontend/motion/plane_support.cpp"
#include <hwy/foreach_target.h>

#include "frontend/geometry/lane_algebra.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

// Distances from a plane, in tolerances.
constexpr double kSupport = 3;         // nearer points speak for the plane, those on it most
constexpr double kBelow = 4;           // points this far below speak against it: one cannot look through a road
constexpr double kBelowPenalty = 0.5;  // of a point below, in points on the plane

/// Four planes.
struct PlaneLanes {
  Doubles3 normal_cam;
  Doubles height_m;
};

/// Truncated quadratic score: the larger the better.
Doubles support(std::span<const LowPoint> points, const PlaneLanes& planes) {
  Doubles sum{};
  for (const auto& c : points) {
    const Doubles x = (planes.height_m - dot(planes.normal_cam, allDoubles(c.p_cam))) / c.tolerance_m;
    const Doubles against = choose(x < -kBelow, Doubles(-kBelowPenalty), 0.0);
    sum += choose((x > -kSupport) & (x < kSupport), 1 - x * x / (kSupport * kSupport), against);
  }
  return sum;
}

}  // namespace

std::vector<double> supportsOf(std::span<const GroundPlane> planes, std::span<const LowPoint> points) {
  std::vector<double> supports;
  for (std::size_t first = 0; first < planes.size(); first += kDoubleLanes) {
    PlaneLanes four{};
    const std::size_t count = std::min(kDoubleLanes, planes.size() - first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      setLane(four.normal_cam, lane, planes[first + lane].normal_cam);
      four.height_m.set(static_cast<int>(lane), planes[first + lane].height_m);
    }
    const Doubles sums = support(points, four);
    for (std::size_t lane = 0; lane < count; ++lane) supports.push_back(sums[static_cast<int>(lane)]);
  }
  return supports;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(supportsOf);

std::vector<double> planeSupports(std::span<const GroundPlane> planes, std::span<const LowPoint> points) {
  return MOTORCADE_KERNEL(supportsOf)(planes, points);
}

}  // namespace motorcade
#endif
