#include "apps/evaluate/box_measures.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

/// An upright cuboid in the camera's frame.
struct Upright {
  Footprint corners;               // (x, z) [m]
  double top_m = 0, bottom_m = 0;  // y, which points down
  Eigen::Vector2d middle, ahead;   // (x, z)
  Eigen::Vector3d size_m;          // length, width, height
  double volume_m3() const { return areaOf(corners) * (bottom_m - top_m); }
};

Upright uprightOf(const Eigen::Vector3d& middle_cam, const Eigen::Vector3d& ahead_cam, const Eigen::Vector3d& size_m) {
  Upright box;
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

Upright labeled(const ObjectTruth& truth) {
  const Eigen::Vector3d size_m(truth.size_m.z(), truth.size_m.y(), truth.size_m.x());
  return uprightOf(truth.T_cam_object * Eigen::Vector3d(0, -0.5 * size_m.z(), 0), truth.T_cam_object.rotation().col(0),
                   size_m);
}

Upright estimated(const ComparedFrame& frame, const ObjectEstimate& object) {
  const SE3 T_cam_body = frame.T_world_cam.inverse() * object.T_world_body;
  return uprightOf(T_cam_body * object.cuboid->center_body, T_cam_body.rotation().col(0), object.cuboid->size_m);
}

double overlapVolume(const Upright& a, const Upright& b) {
  const double height_m = std::min(a.bottom_m, b.bottom_m) - std::max(a.top_m, b.top_m);
  return std::max(0.0, height_m) * overlapArea(a.corners, b.corners);
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Sums {
  std::vector<double> center_m, heading_deg, length_m, width_m, height_m;
  void add(const Upright& estimate, const Upright& label) {
    center_m.push_back((estimate.middle - label.middle).norm());
    const double turn = std::abs(cross(label.ahead, estimate.ahead));
    heading_deg.push_back(std::asin(std::min(1.0, turn)) * 180 / M_PI);
    length_m.push_back(std::abs(estimate.size_m.x() - label.size_m.x()));
    width_m.push_back(std::abs(estimate.size_m.y() - label.size_m.y()));
    height_m.push_back(std::abs(estimate.size_m.z() - label.size_m.z()));
  }
};

}  // namespace

double areaOf(const Footprint& convex) {
  double twice = 0;
  for (std::size_t i = 0; i < convex.size(); ++i) twice += cross(convex[i], convex[(i + 1) % convex.size()]);
  return 0.5 * std::abs(twice);
}

/// Sutherland and Hodgman's clipping: what of `a` lies to the left of every edge of `b`.
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

double intersectionOverUnion(const Box& a, const Box& b) {
  const auto area = [](const Box& box) {
    return std::max(0.0, box.right_px - box.left_px) * std::max(0.0, box.bottom_px - box.top_px);
  };
  const Box both{std::max(a.left_px, b.left_px), std::max(a.top_px, b.top_px), std::min(a.right_px, b.right_px),
                 std::min(a.bottom_px, b.bottom_px)};
  const double either = area(a) + area(b) - area(both);
  return either > 0 ? area(both) / either : 0;
}

BoxErrors boxErrors(const std::vector<ComparedFrame>& frames, double from_m, double to_m) {
  BoxErrors errors;
  Sums sums;
  for (const ComparedFrame& frame : frames) {
    for (const MatchedRow& row : frame.rows) {
      if (row.object < 0 || !row.reported()) continue;
      const TrueObject& object = frame.objects[row.object];
      if (!object.asked() || object.range_m() < from_m || object.range_m() >= to_m) continue;
      ++errors.rows;
      const double iou = intersectionOverUnion(row.row.object.box, object.truth.box);
      errors.iou_2d += iou;
      errors.over_half_2d += iou > 0.5;
      if (!row.row.object.cuboid) continue;
      ++errors.rows_with_cuboid;
      const Upright estimate = estimated(frame, row.row.object), label = labeled(object.truth);
      const double footprint_m2 = overlapArea(estimate.corners, label.corners);
      errors.iou_bird += footprint_m2 / (areaOf(estimate.corners) + areaOf(label.corners) - footprint_m2);
      const double volume_m3 = overlapVolume(estimate, label);
      errors.iou_3d += volume_m3 / (estimate.volume_m3() + label.volume_m3() - volume_m3);
      sums.add(estimate, label);
    }
  }
  for (double* sum : {&errors.iou_2d, &errors.over_half_2d}) *sum /= std::max(1, errors.rows);
  for (double* sum : {&errors.iou_bird, &errors.iou_3d}) *sum /= std::max(1, errors.rows_with_cuboid);
  errors.center_m = statisticsOf(std::move(sums.center_m));
  errors.heading_deg = statisticsOf(std::move(sums.heading_deg));
  errors.length_m = statisticsOf(std::move(sums.length_m));
  errors.width_m = statisticsOf(std::move(sums.width_m));
  errors.height_m = statisticsOf(std::move(sums.height_m));
  return errors;
}

}  // namespace motorcade
