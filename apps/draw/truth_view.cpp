#include "apps/draw/truth_view.hpp"

#include <array>
#include <utility>
#include <vector>

#include "apps/draw/palette.hpp"

namespace motorcade {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

void drawWay(Sheet& sheet, const std::vector<Vector2d>& way) {
  if (way.size() < 2 || !sheet.note(Mark::kTruePath, way)) return;
  sheet.canvas.polyline(way, {.color = kTruth, .width_px = 1.1, .opacity = 0.75, .dashes_px = {5, 4}});
}

void drawLabel(Sheet& sheet, const ObjectTruth& truth, bool moves, const SE3& T_cam_object, const TopMap& map) {
  const double length_m = truth.size_m.z(), width_m = truth.size_m.y();
  std::vector<Vector2d> corners;
  for (const auto& [ahead, aside] : std::array{std::pair(1, 1), std::pair(1, -1), std::pair(-1, -1), std::pair(-1, 1)})
    corners.push_back(map(T_cam_object * Vector3d(0.5 * ahead * length_m, 0, 0.5 * aside * width_m)));
  if (!sheet.note(moves ? Mark::kTrueMover : Mark::kTrueParked, corners)) return;
  if (moves) {
    sheet.canvas.outline(corners, {.color = kTruth, .width_px = 1.3, .dashes_px = {5, 3}});
  } else {
    sheet.canvas.fill(corners, {kDimInk, 0.12});
    sheet.canvas.outline(corners, {.color = kDimInk, .width_px = 1.2, .dashes_px = {1.5, 2.5}});
  }
}

}  // namespace

void paintTruth(Sheet& sheet, const RecordedDrive& drive, std::size_t frame, const TopMap& map) {
  if (frame >= drive.T_world_cam_true.size()) return;
  const SE3 T_cam_world = drive.T_world_cam_true[frame].inverse();
  std::vector<Vector2d> path;
  for (std::size_t i = 0; i <= frame; ++i) path.push_back(map(T_cam_world * drive.T_world_cam_true[i].translation()));
  drawWay(sheet, path);
  const auto here = drive.true_objects.find(static_cast<std::int64_t>(frame));
  if (here == drive.true_objects.end()) return;
  for (const ObjectTruth& truth : here->second) {
    const bool moves = drive.true_movers.contains(truth.id);
    drawLabel(sheet, truth, moves, T_cam_world * truth.T_world_object, map);
    if (!moves) continue;
    std::vector<Vector2d> way;
    for (const auto& [at, objects] : drive.true_objects) {
      if (at > here->first) break;
      for (const ObjectTruth& object : objects)
        if (object.id == truth.id) way.push_back(map(T_cam_world * object.T_world_object.translation()));
    }
    drawWay(sheet, way);
  }
}

}  // namespace motorcade
