#include "frontend/shape/outline_completion.hpp"

#include <algorithm>
#include <vector>

#include <Eigen/Geometry>

#include "frontend/shape/ray_in_box.hpp"

namespace motorcade {
namespace {

/// Volumes of a vehicle's body, down to where one sees the road below it, and of its wheels, away from its ends.
std::vector<Eigen::AlignedBox3d> bodyAndWheels(const BoxEstimate& box) {
  constexpr double kClearance_m = 0.25, kFromEnd_m = 0.45, kDiameter_m = 0.65, kThickness_m = 0.25,
                   kRoundedCorner_m = 0.15;
  constexpr double kLeastLength_m = 2.5;  // shorter ones stand on the road as a whole
  const Eigen::Vector3d least = box.least(), most = box.most();
  const Eigen::Vector3d rounded(kRoundedCorner_m, kRoundedCorner_m, 0);
  if (most.x() - least.x() < kLeastLength_m) return {Eigen::AlignedBox3d(least, most)};
  std::vector<Eigen::AlignedBox3d> parts;
  for (int i = 0; i < 4; ++i) {
    const double x = i & 1 ? most.x() - kFromEnd_m - kDiameter_m : least.x() + kFromEnd_m;
    const double y = i & 2 ? most.y() - kThickness_m : least.y();
    parts.emplace_back(Eigen::Vector3d(x, y, least.z()),
                       Eigen::Vector3d(x + kDiameter_m, y + kThickness_m, least.z() + kDiameter_m));
  }
  parts.emplace_back(least + rounded + kClearance_m * Eigen::Vector3d::UnitZ(), most - rounded);
  return parts;
}

void giveFringeBack(Outline& outline) {
  const auto rows = outline.spansOfRows();
  for (int row = 0; row < outline.window.height; ++row)
    if (const int first = rows[row].first; first > 0 && first < outline.window.width)
      outline.inside[static_cast<std::size_t>(row) * outline.window.width + first - 1] = 1;
}

/// Adds the low parts of the object below the cells that are inside.
void addLowParts(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                 const StereoCamera& camera) {
  const auto columns = outline.spansOfColumns();
  const Eigen::Matrix3d R_body_cam = view.T_cam_body.rotation().transpose();
  const Eigen::Vector3d origin = -R_body_cam * view.T_cam_body.translation();
  const std::vector<Eigen::AlignedBox3d> parts = bodyAndWheels(view.box);
  const auto box = projectedBox(view.box.least(), view.box.most(), view.T_cam_body, camera);
  int end = box ? outline.window.height : 0;
  while (end > 0 && disparities.v_px(end - 1) > box->bottom_px) --end;
  for (int column = 0; column < outline.window.width; ++column) {
    const int lowest = columns[column].second;
    if (lowest < 0) continue;
    for (int row = lowest + 1; row < end; ++row) {
      const Eigen::Vector3d ray((disparities.u_px(column) - camera.cx_px) / camera.fx_px,
                                (disparities.v_px(row) - camera.cy_px) / camera.fy_px, 1);
      const bool hit = std::ranges::any_of(parts, [&](const Eigen::AlignedBox3d& part) {
        const Interval within = insideOf(part.min(), part.max(), origin, R_body_cam * ray);
        return within.begin <= within.end;
      });
      if (hit) outline.inside[static_cast<std::size_t>(row) * outline.window.width + column] = 1;
    }
  }
}

}  // namespace

void completeOutline(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                     const StereoCamera& camera) {
  giveFringeBack(outline);
  addLowParts(outline, disparities, view, camera);
}

}  // namespace motorcade
