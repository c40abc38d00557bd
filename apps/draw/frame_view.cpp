#include "apps/draw/frame_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <utility>

namespace motorcade {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr Color kBackground{17, 21, 27}, kGrid{38, 45, 54}, kDimText{120, 132, 146}, kText{222, 228, 235},
    kTruth{235, 235, 235}, kCamera{255, 255, 255};

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 128> text;
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

std::vector<ObjectEstimate> objectsAt(const DrawnRun& run, std::size_t frame) {
  const auto found = run.objects.find(frame);
  return found == run.objects.end() ? std::vector<ObjectEstimate>() : found->second;
}

/// Where an object was up to a frame, oldest first, in the world.
std::vector<Vector3d> wayOf(const DrawnRun& run, TrackId track, std::size_t frame) {
  std::vector<Vector3d> way;
  for (const auto& [at, objects] : run.objects) {
    if (std::cmp_greater(at, frame)) break;
    for (const auto& object : objects)
      if (object.track == track) way.push_back(object.T_world_body.translation());
  }
  return way;
}

double cameraSpeed_mps(const DrawnRun& run, std::size_t frame) {
  const std::size_t from = frame > 0 ? frame - 1 : 0, to = std::min(from + 1, run.T_world_cam.size() - 1);
  const double dt_s = secondsBetween(run.stamps[from], run.stamps[to]);
  return dt_s > 0 ? (run.T_world_cam[to].translation() - run.T_world_cam[from].translation()).norm() / dt_s : 0;
}

// ---- the image ----

std::vector<Vector2d> projected(const std::vector<Vector3d>& points_cam, const StereoCamera& camera) {
  std::vector<Vector2d> pixels;
  constexpr double kNearest_m = 1.5;  // closer, a line would cross the whole image
  for (const auto& p_cam : points_cam) {
    if (p_cam.z() < kNearest_m) continue;
    const auto uvd_px = camera.project(p_cam);
    if (uvd_px) pixels.emplace_back(uvd_px->x(), uvd_px->y());
  }
  return pixels;
}

void drawBox(Canvas& canvas, const ObjectEstimate& object, Color color) {
  const Box& b = object.box;
  const std::vector<Vector2d> corners{
      {b.left_px, b.top_px}, {b.right_px, b.top_px}, {b.right_px, b.bottom_px}, {b.left_px, b.bottom_px}};
  canvas.fillPolygon(corners, color, 0.14);
  if (object.state != ObjectState::kPredicted) {
    canvas.outline(corners, color, 2.5);
    return;
  }
  std::vector<Vector2d> ring = corners;
  ring.push_back(corners.front());
  canvas.dashedPolyline(ring, color, 2, 6);
}

void drawTag(Canvas& canvas, const Vector2d& corner, const std::string& text, Color color) {
  constexpr int kPad = 3;
  const int width = Canvas::textWidth(text), height = 14;
  Vector2d at(std::clamp(corner.x(), kPad + 0.0, std::max(kPad + 0.0, canvas.width() - width - 2.0 * kPad)),
              std::max(kPad + 1.0, corner.y() - height - 2 * kPad));
  const Vector2d least = at - Vector2d(kPad, kPad), most = at + Vector2d(width + kPad - 1, height + kPad - 1);
  canvas.fillPolygon({least, {most.x(), least.y()}, most, {least.x(), most.y()}}, color, 0.92);
  canvas.text(at, text, {12, 14, 18});
}

/// The edges of an object's cuboid.
void drawCuboid(Canvas& canvas, const DrawnRun& run, const SE3& T_cam_body, const ObjectBox& box, Color color) {
  std::array<std::optional<Vector2d>, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3d to_corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    const auto pixels = projected({T_cam_body * (box.center_body + to_corner.cwiseProduct(box.size_m))}, run.camera);
    if (!pixels.empty()) corners[i] = pixels.front();
  }
  for (int from = 0; from < 8; ++from)
    for (const int axis : {1, 2, 4})
      if (const int to = from | axis; to != from && corners[from] && corners[to])
        canvas.line(*corners[from], *corners[to], color, 1.5);
}

void drawObjectInImage(Canvas& canvas, const DrawnRun& run, std::size_t frame, const ObjectEstimate& object) {
  const Color color = trackColor(object.track);
  const SE3 T_cam_world = run.T_world_cam[frame].inverse();
  std::vector<Vector3d> way_cam;
  for (const auto& p_world : wayOf(run, object.track, frame)) way_cam.push_back(T_cam_world * p_world);
  canvas.polyline(projected(way_cam, run.camera), color, 2, 0.75);
  if (object.state == ObjectState::kMoving) {
    const Vector3d p_world = object.T_world_body.translation();
    const auto ends =
        projected({T_cam_world * p_world, T_cam_world * (p_world + object.velocity_world_mps)}, run.camera);
    if (ends.size() == 2) canvas.arrow(ends[0], ends[1], color, 3);
  }
  if (object.cuboid)
    drawCuboid(canvas, run, T_cam_world * object.T_world_body, *object.cuboid, color);
  else
    drawBox(canvas, object, color);
}

// ---- from above ----

/// Meters ahead and to the right of the camera to pixels: the camera heads right, at a quarter of the width.
struct TopMap {
  int width, height;
  double px_per_m;
  Vector2d operator()(const Vector3d& p_cam) const {
    return {0.26 * width + px_per_m * p_cam.z(), 0.5 * height + px_per_m * p_cam.x()};
  }
};

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

/// A car's outline on the ground, its center at the pose's origin.
std::vector<Vector2d> footprint(const SE3& T_cam_box, const Vector3d& across, double length_m, double width_m,
                                const TopMap& map) {
  std::vector<Vector2d> corners;
  for (const auto& [ahead, aside] : {std::pair(1, 1), std::pair(1, -1), std::pair(-1, -1), std::pair(-1, 1)}) {
    corners.push_back(
        map(T_cam_box * (Vector3d::UnitX() * (0.5 * ahead * length_m) + across * (0.5 * aside * width_m))));
  }
  return corners;
}

void drawCameraFromAbove(Canvas& canvas, const DrawnRun& run, std::size_t frame, const TopMap& map) {
  const double half_width = 0.5 * run.camera.width_px / run.camera.fx_px, far_m = 60;
  canvas.fillPolygon({map({0, 0, 0}), map({half_width * far_m, 0, far_m}), map({-half_width * far_m, 0, far_m})},
                     {120, 150, 190}, 0.09);
  const auto path = [&](const std::vector<SE3>& poses) {
    std::vector<Vector3d> way;
    for (std::size_t i = 0; i <= frame; ++i) way.push_back(poses[i].translation());
    return mapped(way, poses[frame].inverse(), map);
  };
  canvas.polyline(path(run.T_world_cam), kCamera, 3);
  if (frame < run.T_world_cam_true.size()) canvas.dashedPolyline(path(run.T_world_cam_true), {255, 90, 90}, 1.5, 7);
  const Vector2d at = map({0, 0, 0});
  canvas.fillPolygon({at + Vector2d(11, 0), at + Vector2d(-9, 8), at + Vector2d(-9, -8)}, kCamera);
}

void drawTruthFromAbove(Canvas& canvas, const DrawnRun& run, std::size_t frame, const TopMap& map) {
  const auto here = run.true_objects.find(frame);
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
        kTruth, 1.2, 0.7);
  }
}

void drawObjectFromAbove(Canvas& canvas, const DrawnRun& run, std::size_t frame, const ObjectEstimate& object,
                         const TopMap& map) {
  const Color color = trackColor(object.track);
  const SE3 T_cam_world = run.T_world_cam[frame].inverse();
  canvas.polyline(mapped(wayOf(run, object.track, frame), T_cam_world, map), color, 2.5);
  const ObjectBox box = object.cuboid.value_or(kUsualCar);
  const SE3 T_cam_body = T_cam_world * object.T_world_body,
            T_cam_box = T_cam_body * SE3(Eigen::Matrix3d::Identity(), box.center_body);
  const double opacity = object.state == ObjectState::kPredicted ? 0.35 : 0.9;
  const auto outlined = [&](double sigmas) {
    const Vector3d grown_m = box.size_m + 2 * sigmas * (box.center_sigma_m + 0.5 * box.size_sigma_m);
    return footprint(T_cam_box, Vector3d::UnitY(), grown_m.x(), grown_m.y(), map);
  };
  canvas.fillPolygon(outlined(0), color, opacity);
  canvas.outline(outlined(1), color, 1, 0.5);
  const Vector3d p_world = object.T_world_body.translation();
  canvas.arrow(map(T_cam_world * p_world), map(T_cam_world * (p_world + object.velocity_world_mps)), color, 2.5);
  canvas.text(map(T_cam_body.translation()) + Vector2d(-8, 14),
              format("#%lld", static_cast<long long>(object.track.value)), color);
}

/// The ways of objects that were followed once and are no more.
void drawEarlierTracks(Canvas& canvas, const DrawnRun& run, std::size_t frame, const TopMap& map) {
  std::set<TrackId> earlier;
  for (const auto& [at, objects] : run.objects) {
    if (std::cmp_greater(at, frame)) break;
    for (const auto& object : objects) earlier.insert(object.track);
  }
  for (const auto& object : objectsAt(run, frame)) earlier.erase(object.track);
  for (const TrackId track : earlier) {
    canvas.polyline(mapped(wayOf(run, track, frame), run.T_world_cam[frame].inverse(), map), trackColor(track), 2, 0.4);
  }
}

void drawLegend(Canvas& canvas, const DrawnRun& run, std::size_t frame) {
  canvas.text({12, 10}, format("frame %lld", static_cast<long long>(run.first_frame) + static_cast<long long>(frame)),
              kText);
  canvas.text({12, 32}, format("camera %.1f m/s", cameraSpeed_mps(run, frame)), kText);
  const auto objects = objectsAt(run, frame);
  canvas.text(
      {12, 54},
      format("%d moving", static_cast<int>(std::ranges::count(objects, ObjectState::kMoving, &ObjectEstimate::state))),
      kText);
  const double right = canvas.width() - 172.0;
  canvas.line({right, 17}, {right + 40, 17}, kCamera, 3);
  canvas.text({right + 50, 10}, "estimate", kDimText);
  if (run.T_world_cam_true.empty()) return;
  canvas.dashedPolyline({{right, 39}, {right + 40, 39}}, kTruth, 1.5, 6);
  canvas.text({right + 50, 32}, "truth", kDimText);
}

}  // namespace

Color trackColor(TrackId track) {
  constexpr std::array<Color, 10> kColors{{{255, 176, 32},
                                           {64, 196, 255},
                                           {124, 220, 92},
                                           {255, 105, 140},
                                           {186, 138, 255},
                                           {255, 224, 82},
                                           {64, 224, 190},
                                           {255, 138, 80},
                                           {140, 170, 255},
                                           {230, 130, 230}}};
  return kColors[std::max<std::int64_t>(track.value, 0) % kColors.size()];
}

Canvas drawImageView(const Image& left, const DrawnRun& run, std::size_t frame) {
  Canvas canvas(left);
  const auto objects = objectsAt(run, frame);
  for (const auto& object : objects) drawObjectInImage(canvas, run, frame, object);
  for (const auto& object : objects) {  // tags last, over all boxes
    const double range_m = (run.T_world_cam[frame].inverse() * object.T_world_body.translation()).norm();
    const auto text = format("#%lld %.1f m/s %.0f m", static_cast<long long>(object.track.value),
                             object.velocity_world_mps.norm(), range_m);
    drawTag(canvas, {object.box.left_px + 2, object.box.top_px}, text, trackColor(object.track));
  }
  return canvas;
}

Canvas drawTopView(const DrawnRun& run, std::size_t frame, int width, int height) {
  Canvas canvas(width, height, kBackground);
  constexpr double kShown_m = 95;
  const TopMap map{width, height, width / kShown_m};
  drawGrid(canvas, map);
  drawCameraFromAbove(canvas, run, frame, map);
  drawEarlierTracks(canvas, run, frame, map);
  for (const auto& object : objectsAt(run, frame)) drawObjectFromAbove(canvas, run, frame, object, map);
  drawTruthFromAbove(canvas, run, frame, map);
  drawLegend(canvas, run, frame);
  return canvas;
}

Canvas drawFrame(const Image& left, const DrawnRun& run, std::size_t frame) {
  constexpr int kGap_px = 4;
  const int top_height = std::max(240, left.width() * 3 / 10);
  Canvas canvas(left.width(), left.height() + kGap_px + top_height, kBackground);
  canvas.paste(drawImageView(left, run, frame), 0, 0);
  canvas.paste(drawTopView(run, frame, left.width(), top_height), 0, left.height() + kGap_px);
  return canvas;
}

}  // namespace motorcade
