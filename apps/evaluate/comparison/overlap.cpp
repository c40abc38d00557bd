#include "apps/evaluate/comparison/overlap.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double areaInImage(const Box& box) {
  return std::max(0.0, box.right_px - box.left_px) * std::max(0.0, box.bottom_px - box.top_px);
}

/// Intersection over union from the common part and the sum of both.
double iouOf(double common, double sum) { return sum > common ? common / (sum - common) : 0; }

double volumeOf(const UprightCuboid& cuboid) { return areaOf(cuboid.corners) * (cuboid.bottom_m - cuboid.top_m); }

double overlapVolume(const UprightCuboid& a, const UprightCuboid& b) {
  const double height_m = std::min(a.bottom_m, b.bottom_m) - std::max(a.top_m, b.top_m);
  return std::max(0.0, height_m) * overlapArea(a.corners, b.corners);
}

UprightCuboid uprightCuboid(const Eigen::Vector3d& middle_cam, const Eigen::Vector3d& ahead_cam,
                            const Eigen::Vector3d& size_m) {
  UprightCuboid box;
  box.middle = {middle_cam.x(), middle_cam.z()};
  box.ahead = Eigen::Vector2d(ahead_cam.x(), ahead_cam.z()).normalized();
  box.size_m = size_m;
  const Eigen::Vector2d along = 0.5 * size_m.x() * box.ahead,
                        aside = 0.5 * size_m.y() * Eigen::Vector2d(-box.ahead.y(), box.ahead.x());
  box.corners = {box.middle + along - aside, box.middle + along + aside, box.middle - along + aside,
                 box.middle - along - aside};
  box.top_m = middle_cam.y() - 0.5 * size_m.z();
  box.bottom_m = middle_cam.y() + 0.5 * size_m.z();
  return box;
}

}  // namespace

double overlapArea(const Box& a, const Box& b) {
  return areaInImage(Box{std::max(a.left_px, b.left_px), std::max(a.top_px, b.top_px), std::min(a.right_px, b.right_px),
                         std::min(a.bottom_px, b.bottom_px)});
}

double intersectionOverUnion(const Box& a, const Box& b) {
  return iouOf(overlapArea(a, b), areaInImage(a) + areaInImage(b));
}

double areaOf(const Footprint& convex) {
  double twice = 0;
  for (std::size_t i = 0; i < convex.size(); ++i) twice += cross(convex[i], convex[(i + 1) % convex.size()]);
  return 0.5 * std::abs(twice);
}

/// Clips `a` by every edge of `b` (Sutherland and Hodgman), and returns the area that is left.
double overlapArea(const Footprint& a, const Footprint& b) {
  Footprint rest = a;
  for (std::size_t edge = 0; edge < b.size() && !rest.empty(); ++edge) {
    const Eigen::Vector2d& from = b[edge];
    const Eigen::Vector2d along = b[(edge + 1) % b.size()] - from;
    Footprint kept;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Eigen::Vector2d &p = rest[i], &q = rest[(i + 1) % rest.size()];
      const double of_p = cross(along, p - from), of_q = cross(along, q - from);
      if (of_p >= 0) kept.push_back(p);
      if ((of_p < 0) != (of_q < 0)) kept.push_back(p + of_p / (of_p - of_q) * (q - p));
    }
    rest = std::move(kept);
  }
  return rest.empty() ? 0 : areaOf(rest);
}

UprightCuboid labeledCuboid(const ObjectTruth& truth) {
  const Eigen::Vector3d size_m(truth.size_m.z(), truth.size_m.y(), truth.size_m.x());
  return uprightCuboid(truth.T_cam_object * Eigen::Vector3d(0, -0.5 * size_m.z(), 0),
                       truth.T_cam_object.rotation().col(0), size_m);
}

UprightCuboid estimatedCuboid(const SE3& T_world_cam, const ObjectEstimate& object) {
  const SE3 T_cam_body = T_world_cam.inverse() * object.T_world_body;
  return uprightCuboid(T_cam_body * object.cuboid->center_body, T_cam_body.rotation().col(0), object.cuboid->size_m);
}

double footprintIou(const UprightCuboid& a, const UprightCuboid& b) {
  return iouOf(overlapArea(a.corners, b.corners), areaOf(a.corners) + areaOf(b.corners));
}

double volumeIou(const UprightCuboid& a, const UprightCuboid& b) {
  return iouOf(overlapVolume(a, b), volumeOf(a) + volumeOf(b));
}

}  // namespace motorcade
