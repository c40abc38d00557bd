#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "apps/draw/palette.hpp"
#include "apps/draw/seen_extent.hpp"
#include "apps/draw/tags.hpp"
#include "apps/draw/top_map.hpp"
#include "apps/draw/views.hpp"
#include "core/object_place.hpp"

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

using Eigen::Vector2d, Eigen::Vector3d;

/// State that every part of the view needs.
struct View {
  Sheet& sheet;
  const RecordedDrive& drive;
  std::size_t frame;
  SE3 T_cam_world;
  TopMap map;

  Vector2d at(const Vector3d& p_world) const { return map(T_cam_world * p_world); }
  std::vector<Vector2d> at(const std::vector<Vector3d>& points_world) const {
    std::vector<Vector2d> points;
    for (const auto& p_world : points_world) points.push_back(at(p_world));
    return points;
  }
};

/// The least of 1, 2, 5, 10, ... m that leaves room between lines.
double gridStep_m(double px_per_m) {
  constexpr double kApart_px = 70;
  for (double decade = 1; decade < 1e6; decade *= 10)
    for (const double step_m : {decade, 2 * decade, 5 * decade})
      if (step_m * px_per_m >= kApart_px) return step_m;
  return 1e6;
}

void drawGrid(Canvas& canvas, const TopMap& map) {
  const double width = canvas.width(), height = canvas.height(), step_m = gridStep_m(map.px_per_m);
  const TextStyle style{.color = kDimInk, .size_px = 10.5};
  const auto lines = [&](double origin, double size, const auto& draw) {
    for (auto k = static_cast<int>(std::ceil(-origin / (step_m * map.px_per_m)));; ++k) {
      const double at = std::round(origin + k * step_m * map.px_per_m);
      if (at > size) break;
      draw(at, k * step_m);
    }
  };
  lines(map.origin_px.x(), width, [&](double x, double m) {
    canvas.line({x, 0}, {x, height}, {.color = kGridLine, .opacity = m == 0 ? 0.999 : 0.6});
    if (x < width - 40) canvas.text({x + 5, height - 7}, fmt::format("{:.0f} m", m), style);
  });
  lines(map.origin_px.y(), height, [&](double y, double m) {
    canvas.line({0, y}, {width, y}, {.color = kGridLine, .opacity = m == 0 ? 0.999 : 0.6});
    if (m != 0 && y > 14 && y < height - 22)
      canvas.text({6, y - 5}, fmt::format("{:.0f} m {}", std::abs(m), m < 0 ? "left" : "right"), style);
  });
}

void drawOwnCamera(const View& view) {
  constexpr double kFar_m = 200;
  Canvas& canvas = view.sheet.canvas;
  const double half_width = 0.5 * view.drive.camera.width_px / view.drive.camera.fx_px;
  const std::array field{view.map({0, 0, 0}), view.map({half_width * kFar_m, 0, kFar_m}),
                         view.map({-half_width * kFar_m, 0, kFar_m})};
  canvas.fill(field, {kOwn, 0.07});
}

void drawOwnPath(const View& view) {
  constexpr double kPath_px = 2.6;
  std::vector<Vector3d> way;
  for (std::size_t i = 0; i <= view.frame; ++i) way.push_back(view.drive.T_world_cam[i].translation());
  const auto path = view.at(way);
  if (path.size() > 1 && view.sheet.note(Mark::kOwnPath, path))
    view.sheet.canvas.polyline(path, {.color = kOwn, .width_px = kPath_px});
  const Vector2d at = view.map({0, 0, 0});
  const std::array corners{Vector2d(at + Vector2d(12, 0)), Vector2d(at + Vector2d(-8, 8)),
                           Vector2d(at + Vector2d(-4, 0)), Vector2d(at + Vector2d(-8, -8))};
  if (!view.sheet.note(Mark::kOwnCamera, corners)) return;
  view.sheet.canvas.outline(corners, {.color = kDark, .width_px = 3, .opacity = 0.7});
  view.sheet.canvas.fill(corners, {kOwn, 1});
}

/// Draws the paths of the present objects and, fainter, of those followed earlier.
void drawWays(const View& view) {
  std::set<TrackId> earlier;
  for (const auto& [at, objects] : view.drive.objects) {
    if (std::cmp_greater(at, view.frame)) break;
    for (const auto& object : objects) earlier.insert(object.track);
  }
  const auto objects = view.drive.objectsAt(view.frame);
  for (const auto& object : objects) earlier.erase(object.track);
  const auto draw = [&](TrackId track, const Vector3d& p_body, Mark mark, const Pen& pen) {
    const auto way = view.at(view.drive.wayOf(track, p_body, 0, view.frame));
    if (way.size() > 1 && view.sheet.note(mark, way)) view.sheet.canvas.polyline(way, pen);
  };
  for (const TrackId track : earlier)
    draw(track, Vector3d::Zero(), Mark::kEarlierWay, {.color = trackColor(track), .width_px = 1.5, .opacity = 0.4});
  for (const auto& object : objects) {
    const auto extent = seenExtent(view.drive, view.frame, object);
    draw(object.track, extent ? extent->middle_body() : Vector3d::Zero(), Mark::kWay,
         {.color = trackColor(object.track), .width_px = 2, .opacity = 0.8});
  }
}

std::vector<Vector2d> footprint(const View& view, const ObjectEstimate& object, const SeenExtent& extent) {
  const Vector3d &least = extent.least_body, &most = extent.most_body;
  return view.at({object.T_world_body * Vector3d(most.x(), most.y(), least.z()),
                  object.T_world_body * Vector3d(most.x(), least.y(), least.z()),
                  object.T_world_body * Vector3d(least.x(), least.y(), least.z()),
                  object.T_world_body * Vector3d(least.x(), most.y(), least.z())});
}

void drawFootprint(const View& view, const ObjectEstimate& object, const SeenExtent& extent) {
  const Color color = trackColor(object.track);
  const auto corners = footprint(view, object, extent);
  const bool predicted = object.state == ObjectState::kPredicted;
  if (!view.sheet.note(predicted ? Mark::kPredicted : Mark::kFootprint, corners)) return;
  Canvas& canvas = view.sheet.canvas;
  canvas.fill(corners, {color, predicted ? 0.15 : 0.85});
  if (predicted) {
    canvas.outline(corners, {.color = color, .width_px = 1.5, .dashes_px = {4, 3}});
    return;
  }
  canvas.outline(corners, {.color = lightened(color), .width_px = 1});
  // The direction that it faces, also when it stands.
  const Vector2d front = 0.5 * (corners[0] + corners[1]), side = 0.3 * (corners[1] - corners[0]);
  const Vector2d back = corners[3] - corners[0];
  if (!(back.norm() > 0)) return;
  const Vector2d to_back = back.normalized() * std::min(side.norm() * 1.4, 0.7 * back.norm()),
                 tip = front + 0.15 * to_back;
  const std::array notch{tip, Vector2d(tip + side + to_back), Vector2d(tip - side + to_back)};
  canvas.fill(notch, {kDark, 0.55});
}

/// Draws the two-sigma ellipse of the cuboid's middle, where its covariance is known.
void drawEllipse(const View& view, const ObjectEstimate& object) {
  constexpr double kSigmas = 2;
  const ObjectPlace place = placeOf(object);
  const Eigen::Matrix3d& R = view.T_cam_world.rotation();
  const Eigen::Matrix3d covariance = R * place.center_covariance * R.transpose();
  Eigen::Matrix2d on_ground;  // ahead and to the right
  on_ground << covariance(2, 2), covariance(2, 0), covariance(0, 2), covariance(0, 0);
  if (!on_ground.allFinite() || !(on_ground.trace() > 0)) return;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(on_ground);
  const Eigen::Matrix2d axes = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  const auto corners = ellipse(view.at(place.center_world), kSigmas * view.map.px_per_m * axes);
  if (!view.sheet.note(Mark::kEllipse, corners)) return;
  view.sheet.canvas.fill(corners, {lightened(trackColor(object.track)), 0.25});
  view.sheet.canvas.outline(corners, {.color = kDark, .width_px = 3, .opacity = 0.5});
  view.sheet.canvas.outline(corners, {.color = lightened(lightened(trackColor(object.track))), .width_px = 1.2});
}

void drawMotion(const View& view, const ObjectEstimate& object, const Vector3d& front_body) {
  if (object.state == ObjectState::kStopped) return;
  const Vector3d front_world = object.T_world_body * front_body;
  const std::array ends{view.at(front_world), view.at(front_world + object.velocity_world_mps)};
  if (!view.sheet.note(Mark::kMotion, ends)) return;
  view.sheet.canvas.arrow(ends[0], ends[1], {.color = trackColor(object.track), .width_px = 2.2});
}

/// Draws followed points, each at the distance of its disparity.
void drawPoints(const View& view) {
  for (const ObjectPoint& point : view.drive.pointsAt(view.frame)) {
    if (!(point.uvd_px.z() > 0)) continue;
    const std::array at{view.map(view.drive.camera.triangulate(point.uvd_px))};
    if (!view.sheet.note(Mark::kPoint, at)) continue;
    view.sheet.canvas.dot(at[0], 2.1, {kDark, 0.7});
    view.sheet.canvas.dot(at[0], 1.3, {lightened(lightened(trackColor(point.track))), 1});
  }
}

Rectangle boundsOf(const std::vector<Vector2d>& corners) {
  Vector2d least = corners.front(), most = corners.front();
  for (const Vector2d& corner : corners) {
    least = least.cwiseMin(corner);
    most = most.cwiseMax(corner);
  }
  return {least.x(), least.y(), most.x() - least.x(), most.y() - least.y()};
}

/// Paints from above the true paths of camera and movers, and the positions of movers and parked cars.
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

void drawObjects(const View& view) {
  std::vector<Tag> tags;
  const auto objects = view.drive.objectsAt(view.frame);
  for (const ObjectEstimate& object : objects) {
    const auto extent = seenExtent(view.drive, view.frame, object);
    if (extent) drawFootprint(view, object, *extent);
    const Vector3d front_body =
        extent ? Vector3d(extent->most_body.x(), extent->middle_body().y(), 0) : Vector3d(0, 0, 0);
    drawMotion(view, object, front_body);
    const auto corners =
        extent ? footprint(view, object, *extent) : std::vector<Vector2d>{view.at(object.T_world_body.translation())};
    const Rectangle bounds = boundsOf(corners);
    if (view.sheet.area().overlap(bounds.grownBy(1)) > 0)
      tags.push_back({trackColor(object.track), fmt::format("#{}", object.track.value), "", bounds});
  }
  drawPoints(view);
  for (const ObjectEstimate& object : objects) drawEllipse(view, object);
  paintTruth(view.sheet, view.drive, view.frame, view.map);
  paintTags(view.sheet, tags);
}

}  // namespace

void paintTopView(Sheet& sheet, const RecordedDrive& drive, std::size_t frame) {
  constexpr double kLabels_px = 22;  // of the grid, at the lower edge
  Rectangle area = sheet.area();
  area.height -= kLabels_px;
  const TopMap map = topMapOf(drive, frame, area);
  drawGrid(sheet.canvas, map);
  if (frame >= drive.T_world_cam.size()) return;
  const View view{sheet, drive, frame, drive.T_world_cam[frame].inverse(), map};
  drawOwnCamera(view);
  drawWays(view);
  drawOwnPath(view);
  drawObjects(view);
}

}  // namespace motorcade
