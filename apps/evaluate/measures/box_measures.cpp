#include "apps/evaluate/measures/box_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/evaluate/comparison/overlap.hpp"

namespace motorcade {
namespace {

/// The angle between two axes, as if neither had a front.
double turn_deg(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double sine = std::abs(a.x() * b.y() - a.y() * b.x());
  return std::asin(std::min(1.0, sine)) * 180 / std::numbers::pi;
}

struct Sums {
  std::vector<double> center_m, heading_deg, length_m, width_m, height_m;
  void add(const UprightCuboid& estimate, const UprightCuboid& label) {
    center_m.push_back((estimate.middle - label.middle).norm());
    heading_deg.push_back(turn_deg(label.ahead, estimate.ahead));
    length_m.push_back(std::abs(estimate.size_m.x() - label.size_m.x()));
    width_m.push_back(std::abs(estimate.size_m.y() - label.size_m.y()));
    height_m.push_back(std::abs(estimate.size_m.z() - label.size_m.z()));
  }
};

}  // namespace

BoxErrors boxErrors(const std::vector<ComparedFrame>& frames, double from_m, double to_m) {
  BoxErrors errors;
  Sums sums;
  for (const auto& [frame, object, row] : askedPairs(frames, from_m, to_m)) {
    ++errors.rows;
    const double iou = intersectionOverUnion(row->row.object.box, object->truth.box);
    errors.iou_2d += iou;
    errors.over_half_2d += iou > 0.5;
    if (!row->row.object.cuboid) continue;
    ++errors.rows_with_cuboid;
    const UprightCuboid estimate = estimatedCuboid(frame->T_world_cam, row->row.object),
                        label = labeledCuboid(object->truth);
    errors.iou_bird += footprintIou(estimate, label);
    errors.iou_3d += volumeIou(estimate, label);
    sums.add(estimate, label);
    const Eigen::Array3d two_sigma_m = 2 * row->row.object.cuboid->size_sigma_m.array();
    errors.size_within_2_sigma += ((estimate.size_m - label.size_m).array().abs() <= two_sigma_m).cast<double>();
  }
  for (double* sum : {&errors.iou_2d, &errors.over_half_2d}) *sum /= std::max(1, errors.rows);
  for (double* sum : {&errors.iou_bird, &errors.iou_3d}) *sum /= std::max(1, errors.rows_with_cuboid);
  errors.size_within_2_sigma /= std::max(1, errors.rows_with_cuboid);
  errors.center_m = statisticsOf(std::move(sums.center_m));
  errors.heading_deg = statisticsOf(std::move(sums.heading_deg));
  errors.length_m = statisticsOf(std::move(sums.length_m));
  errors.width_m = statisticsOf(std::move(sums.width_m));
  errors.height_m = statisticsOf(std::move(sums.height_m));
  return errors;
}

}  // namespace motorcade
