#include "frontend/motion/plane_support.hpp"

#include <algorithm>
#include <vector>

#include "frontend/geometry/double_lanes.hpp"

namespace motorcade {
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
    const Doubles x = (planes.height_m - dot(planes.normal_cam, allDoubles(c.p_cam))) / allDoubles(c.tolerance_m);
    const Doubles against = x < -kBelow ? allDoubles(-kBelowPenalty) : Doubles{};
    sum += x > -kSupport && x < kSupport ? 1 - x * x / (kSupport * kSupport) : against;
  }
  return sum;
}

}  // namespace

std::size_t mostSupported(std::span<const GroundPlane> planes, std::span<const LowPoint> points) {
  std::vector<double> supports;
  for (std::size_t first = 0; first < planes.size(); first += kDoubleLanes) {
    PlaneLanes four{};
    const std::size_t count = std::min(kDoubleLanes, planes.size() - first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      setLane(four.normal_cam, lane, planes[first + lane].normal_cam);
      four.height_m[lane] = planes[first + lane].height_m;
    }
    const Doubles sums = support(points, four);
    for (std::size_t lane = 0; lane < count; ++lane) supports.push_back(sums[lane]);
  }
  return static_cast<std::size_t>(std::ranges::max_element(supports) - supports.begin());
}

}  // namespace motorcade
