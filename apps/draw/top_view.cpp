#include "apps/draw/top_view.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/object_place.hpp"

namespace motorcade {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr Color kGrid{38, 45, 54}, kDimText{120, 132, 146}, kText{222, 228, 235}, kTruth{235, 235, 235},
    kCamera{255, 255, 255}, kTrueCamera{255, 90, 90}, kDark{17, 21, 27};
constexpr double kSigmas = 2;  // of the footprint's margin

/// Meters ahead and to the right of the camera to pixels: the camera heads right, at a quarter of the width.
struct TopMap {
  int width, height;
  double px_per_m;
  Vector2d operator()(const Vector3d& p_cam) const {
    return {0.26 * width + px_per_m * p_cam.z(), 0.5 * height + px_per_m * p_cam.x()};
  }
};

double cameraSpeed_mps(const RecordedDrive& run, std::size_t frame) {
  const std::size_t from = frame > 0 ? frame - 1 : 0, to = std::min(from + 1, run.T_world_cam.size() - 1);
  const double dt_s = secondsBetween(run.stamps[from], run.stamps[to]);
  return dt_s > 0 ? (run.T_world_cam[to].translation() - run.T_world_cam[from].translation()).norm() / dt_s : 0;
}

void drawGrid(Canvas& canvas, const TopMap& map) {
  constexpr int kReach_m = 120, kStep_m = 10;
  for (int m = -kReach_m; m <= kReach_m; m += kStep_m) {
    const double x = map({0, 0, static_cast<double>(m)}).x(), y = map({static_cast<double>(m), 0, 0}).y();
    canvas.line({x, 0}, {x, static_cast<double>(map.height)}, kGrid, 1);
    canvas.line({0, y}, {static_cast<double>(map.width), y}, kGrid, 1);
    if (m % (2 * kStep_m) == 0) canvas.text({x + 4, map.height - 20.0}, format("%d m", m), kDimText);
  }
}

std::vector<Vector2d> mapped(const std::vector<Vector3d>& points_world, const SE3& T_cam_world, const TopMap& map) {
  std::vector<Vector2d> points;
  for (const auto& p_world : points_world) points.push_back(map(T_cam_world * p_world));
  return points;
}

/// Stands for what a run without cuboids does not know.
const ObjectBox kUsualCar{.size_m = {4.2, 1.8, 1.5}};

/// An outline on the ground, its center at the pose's origin.
std::vector<Vector2d> footprint(const SE3& T_cam_box, const Vector3d& across, double length_m, double width_m,
                                const TopMap& map) {
  std::vector<Vector2d> corners;
  for (const auto& [ahead, aside] : {std::pair(1, 1), std::pair(1, -1), std::pair(-1, -1), std::pair(-1, 1)}) {
    corners.push_back(
        map(T_cam_box * (Vector3d::UnitX() * (0.5 * ahead * length_m) + across * (0.5 * aside * width_m))));
  }
  return corners;
}

void drawCameraFromAbove(Canvas& canvas, const RecordedDrive& run, std::size_t frame, const TopMap& map) {
  const double half_width = 0.5 * run.camera.width_px / run.camera.fx_px, far_m = 60;
  canvas.fillPolygon({map({0, 0, 0}), map({half_width * far_m, 0, far_m}), map({-half_width * far_m, 0, far_m})},
                     {120, 150, 190}, 0.09);
  const auto path = [&](const std::vector<SE3>& poses) {
    std::vector<Vector3d> way;
    for (std::size_t i = 0; i <= frame; ++i) way.push_back(poses[i].translation());
    return mapped(way, poses[frame].inverse(), map);
  };
  canvas.polyline(path(run.T_world_cam), kCamera, 3);
  if (frame < run.T_world_cam_true.size()) canvas.dashedPolyline(path(run.T_world_cam_true), kTrueCamera, 1.5, 7);
  const Vector2d at = map({0, 0, 0});
  canvas.fillPolygon({at + Vector2d(11, 0), at + Vector2d(-9, 8), at + Vector2d(-9, -8)}, kCamera);
}

void drawTruthFromAbove(Canvas& canvas, const RecordedDrive& run, std::size_t frame, const TopMap& map) {
  const auto here = run.true_objects.find(static_cast<std::int64_t>(frame));
  if (here == run.true_objects.end() || frame >= run.T_world_cam_true.size()) return;
  const SE3 T_cam_world = run.T_world_cam_true[frame].inverse();
  for (const auto& truth : here->second) {
    std::vector<Vector3d> way;
    for (const auto& [at, objects] : run.true_objects) {
      if (at > here->first) break;
      for (const auto& object : objects)
        if (object.id == truth.id) way.push_back(object.T_world_object.translation());
    }
    canvas.dashedPolyline(mapped(way, T_cam_world, map), kTruth, 1.2, 6, 0.7);
    canvas.outline(
        footprint(T_cam_world * truth.T_world_object, Vector3d::UnitZ(), truth.size_m.z(), truth.size_m.y(), map),
        kTruth, 1.2, 0.8);
  }
}

/// By how much each end of a footprint may be off, along the body's axes: the place of its middle and half its size.
Vector3d footprintSigma_m(const ObjectEstimate& object, const ObjectBox& box) {
  const Eigen::Matrix3d& R = object.T_world_body.rotation();
  const Vector3d place_m2 = (R.transpose() * placeOf(object).center_covariance * R).diagonal();
  return (place_m2 + 0.25 * box.size_sigma_m.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
}

void drawFootprint(Canvas& canvas, const ObjectEstimate& object, const SE3& T_cam_body, const TopMap& map) {
  const Color color = trackColor(object.track);
  const ObjectBox box = object.cuboid.value_or(kUsualCar);
  const SE3 T_cam_box = T_cam_body * SE3(Eigen::Matrix3d::Identity(), box.center_body);
  const auto outlined = [&](const Vector3d& size_m) {
    return footprint(T_cam_box, Vector3d::UnitY(), size_m.x(), size_m.y(), map);
  };
  const bool predicted = object.state == ObjectState::kPredicted;
  const auto margin = outlined(box.size_m + 2 * kSigmas * footprintSigma_m(object, box));
  canvas.fillPolygon(margin, color, 0.18);
  canvas.outline(margin, color, 1, 0.45);
  canvas.fillPolygon(outlined(box.size_m), color, predicted ? 0.35 : 0.85);
  // The way that it heads, also when it stands.
  const double nose_m = 0.5 * box.size_m.x(), half_m = 0.3 * box.size_m.y(), back_m = nose_m - 2 * half_m;
  canvas.fillPolygon({map(T_cam_box * Vector3d(0.95 * nose_m, 0, 0)), map(T_cam_box * Vector3d(back_m, half_m, 0)),
                      map(T_cam_box * Vector3d(back_m, -half_m, 0))},
                     kDark, 0.7);
}

void drawObjectFromAbove(Canvas& canvas, const RecordedDrive& run, std::size_t frame, const ObjectEstimate& object,
                         const TopMap& map) {
  const SE3 T_cam_world = run.T_world_cam[frame].inverse(), T_cam_body = T_cam_world * object.T_world_body;
  const ObjectBox box = object.cuboid.value_or(kUsualCar);
  drawFootprint(canvas, object, T_cam_body, map);
  if (object.state == ObjectState::kStopped) return;
  const Vector3d nose_cam = T_cam_body * (box.center_body + Vector3d(0.5 * box.size_m.x(), 0, 0)),
                 motion_cam = T_cam_world.rotation() * object.velocity_world_mps;
  canvas.arrow(map(nose_cam), map(nose_cam + motion_cam), trackColor(object.track), 2);
}

/// On a dark plate below the footprint, over all else.
void drawName(Canvas& canvas, const RecordedDrive& run, std::size_t frame, const ObjectEstimate& object,
              const TopMap& map) {
  const ObjectBox box = object.cuboid.value_or(kUsualCar);
  const Vector3d middle_cam = run.T_world_cam[frame].inverse() * (object.T_world_body * box.center_body);
  const auto name = format("#%lld", static_cast<long long>(object.track.value));
  const double below_px = 0.5 * map.px_per_m * std::max(box.size_m.y(), 2.0) + 8, width_px = Canvas::textWidth(name);
  const Vector2d at = map(middle_cam) + Vector2d(-0.5 * width_px, below_px), size_px(width_px, 14);
  canvas.fillPolygon({at, at + Vector2d(size_px.x(), 0), at + size_px, at + Vector2d(0, size_px.y())}, kDark, 0.7);
  canvas.text(at, name, trackColor(object.track));
}

/// Followed points, each at the distance that its disparity says.
void drawPointsFromAbove(Canvas& canvas, const RecordedDrive& run, std::size_t frame, const TopMap& map) {
  for (const ObjectPoint& point : run.pointsAt(frame)) {
    if (!(point.uvd_px.z() > 0)) continue;
    const Vector2d at = map(run.camera.triangulate(point.uvd_px));
    canvas.line(at, at, kDark, 3.5, 0.6);
    canvas.line(at, at, lightened(trackColor(point.track)), 2);
  }
}

/// Of the objects that are there, and, fainter, of those that were followed once.
void drawWays(Canvas& canvas, const RecordedDrive& run, std::size_t frame, const TopMap& map) {
  std::set<TrackId> earlier;
  for (const auto& [at, objects] : run.objects) {
    if (std::cmp_greater(at, frame)) break;
    for (const auto& object : objects) earlier.insert(object.track);
  }
  const auto draw = [&](TrackId track, const Vector3d& p_body, double opacity) {
    const auto way = run.wayOf(track, p_body, 0, frame);
    canvas.polyline(mapped(way, run.T_world_cam[frame].inverse(), map), trackColor(track), 2, opacity);
  };
  const auto objects = run.objectsAt(frame);
  for (const auto& object : objects) earlier.erase(object.track);
  for (const TrackId track : earlier) draw(track, Vector3d::Zero(), 0.4);
  for (const auto& object : objects) draw(object.track, object.cuboid.value_or(kUsualCar).center_body, 1);
}

void drawLegend(Canvas& canvas, const RecordedDrive& run, std::size_t frame) {
  canvas.text({12, 10}, format("frame %lld", static_cast<long long>(run.first_frame) + static_cast<long long>(frame)),
              kText);
  canvas.text({12, 32}, format("camera %.1f m/s", cameraSpeed_mps(run, frame)), kText);
  const auto objects = run.objectsAt(frame);
  canvas.text(
      {12, 54},
      format("%d moving", static_cast<int>(std::ranges::count(objects, ObjectState::kMoving, &ObjectEstimate::state))),
      kText);
  const double left = canvas.width() - 172.0;
  const std::vector<Vector2d> estimated{{left + 8, 12}, {left + 32, 12}, {left + 32, 22}, {left + 8, 22}},
      margin{{left + 2, 8}, {left + 38, 8}, {left + 38, 26}, {left + 2, 26}};
  canvas.fillPolygon(margin, kCamera, 0.18);
  canvas.outline(margin, kCamera, 1, 0.45);
  canvas.fillPolygon(estimated, kCamera, 0.85);
  canvas.text({left + 50, 10}, format("%.0f sigma", kSigmas), kDimText);
  if (run.T_world_cam_true.empty()) return;
  canvas.dashedPolyline({{left, 39}, {left + 40, 39}}, kTruth, 1.5, 6);
  canvas.text({left + 50, 32}, "truth", kDimText);
}

}  // namespace

Canvas drawTopView(const RecordedDrive& run, std::size_t frame, int width, int height) {
  Canvas canvas(width, height, kDark);
  constexpr double kShown_m = 95;
  const TopMap map{width, height, width / kShown_m};
  drawGrid(canvas, map);
  drawCameraFromAbove(canvas, run, frame, map);
  drawWays(canvas, run, frame, map);
  for (const auto& object : run.objectsAt(frame)) drawObjectFromAbove(canvas, run, frame, object, map);
  drawPointsFromAbove(canvas, run, frame, map);
  drawTruthFromAbove(canvas, run, frame, map);
  for (const auto& object : run.objectsAt(frame)) drawName(canvas, run, frame, object, map);
  drawLegend(canvas, run, frame);
  return canvas;
}

}  // namespace motorcade
