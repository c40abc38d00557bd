#include "frontend/shape/outline_completion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace motorcade {
namespace {

struct Interval {
  double begin, end;
};

/// Interval of a ray, origin + t * direction, within a box; empty intervals end before they begin.
Interval insideOf(const Eigen::Vector3d& least, const Eigen::Vector3d& most, const Eigen::Vector3d& origin,
                  const Eigen::Vector3d& direction) {
  Interval inside{0, 1e9};
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1 / (std::abs(direction[axis]) > 1e-9 ? direction[axis] : 1e-9);
    double in = (least[axis] - origin[axis]) * inverse, out = (most[axis] - origin[axis]) * inverse;
    if (in > out) std::swap(in, out);
    inside.begin = std::max(inside.begin, in);
    inside.end = std::min(inside.end, out);
  }
  return inside;
}

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

namespace {

/// Number of the window's cells that a label covers.
struct Cover {
  int cells = 0, shared = 0;  // shared with the outline
  bool goes_on = false;       // beyond the window
};

/// The label at the middle of each cell.
std::vector<std::uint16_t> labelsOfCells(const Outline& outline, const LevelDisparities& disparities,
                                         const InstanceLabels& labels) {
  std::vector<std::uint16_t> of_cells;
  of_cells.reserve(outline.inside.size());
  for (int row = 0; row < outline.window.height; ++row)
    for (int column = 0; column < outline.window.width; ++column)
      of_cells.push_back(labels.at(disparities.u_px(column), disparities.v_px(row)));
  return of_cells;
}

}  // namespace

std::optional<Outline> labelledOutline(const Outline& outline, const LevelDisparities& disparities,
                                       const InstanceLabels& labels) {
  const std::vector<std::uint16_t> of_cells = labelsOfCells(outline, disparities, labels);
  const int width = outline.window.width, height = outline.window.height;
  const PixelWindow& window = outline.window;
  const int image_columns = labels.width() >> disparities.level, image_rows = labels.height() >> disparities.level;
  const auto isBorder = [&](int column, int row) {  // of the window, within the image
    return (column == 0 && window.u0 > 0) || (column == width - 1 && window.u0 + width < image_columns) ||
           (row == 0 && window.v0 > 0) || (row == height - 1 && window.v0 + height < image_rows);
  };
  std::map<std::uint16_t, Cover> covers;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const std::uint16_t label = of_cells[static_cast<std::size_t>(row) * width + column];
      if (label == 0) continue;
      Cover& cover = covers[label];
      ++cover.cells;
      cover.shared += outline.at(column, row);
      cover.goes_on = cover.goes_on || isBorder(column, row);
    }
  const int own = outline.count();
  for (const auto& [label, cover] : covers) {
    if (cover.goes_on || 2 * cover.shared <= own + cover.cells - cover.shared) continue;
    Outline labelled{.window = outline.window, .inside = {}};
    for (const std::uint16_t of_cell : of_cells) labelled.inside.push_back(of_cell == label ? 1 : 0);
    return labelled;
  }
  return std::nullopt;
}

}  // namespace motorcade
