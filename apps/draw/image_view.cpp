#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/draw/palette.hpp"
#include "apps/draw/seen_extent.hpp"
#include "apps/draw/tags.hpp"
#include "apps/draw/views.hpp"
#include "io/images/mask_image.hpp"
#include "io/results/object_row.hpp"
#include "io/results/outline_polygons.hpp"

namespace motorcade {
namespace {

/// Bounding box of the pixels of one value.
struct Bounds {
  int left, top, right, bottom;
};

std::map<std::uint16_t, Bounds> boundsByValue(const Gray16Image& mask) {
  std::map<std::uint16_t, Bounds> all;
  const std::uint16_t* pixel = mask.pixels.data();
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x, ++pixel) {
      if (*pixel == 0) continue;
      Bounds& bounds = all.try_emplace(*pixel, Bounds{x, y, x, y}).first->second;
      bounds.left = std::min(bounds.left, x);
      bounds.right = std::max(bounds.right, x);
      bounds.bottom = y;
    }
  }
  return all;
}

/// True when each square of pixels is all of the value or none of it. Masks are then made of such cells, or larger
/// ones.
bool isMadeOf(int cell_px, const Gray16Image& mask, std::uint16_t value, const Bounds& bounds) {
  const auto isSet = [&](int x, int y) {
    return mask.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                       static_cast<std::size_t>(x)] == value;
  };
  for (int y = bounds.top; y <= bounds.bottom; ++y)
    for (int x = bounds.left; x <= bounds.right; ++x)
      if (isSet(x, y) != isSet(x - (x - bounds.left) % cell_px, y - (y - bounds.top) % cell_px)) return false;
  return true;
}

ObjectMask cut(const Gray16Image& mask, std::uint16_t value, const Bounds& bounds) {
  int cell_px = 8;
  while (cell_px > 1 && !isMadeOf(cell_px, mask, value, bounds)) cell_px /= 2;
  ObjectMask object{.track = trackOfMask(value),
                    .left_px = bounds.left,
                    .top_px = bounds.top,
                    .cell_px = cell_px,
                    .width = (bounds.right - bounds.left) / cell_px + 1,
                    .height = (bounds.bottom - bounds.top) / cell_px + 1,
                    .inside = {}};
  for (int row = 0; row < object.height; ++row)
    for (int column = 0; column < object.width; ++column) {
      const auto at = static_cast<std::size_t>(bounds.top + row * cell_px) * static_cast<std::size_t>(mask.width) +
                      static_cast<std::size_t>(bounds.left + column * cell_px);
      object.inside.push_back(mask.pixels[at] == value ? 1 : 0);
    }
  return object;
}

/// Cuts the corners of a closed outline twice, each side's by a quarter (Chaikin 1974) or, where it is long, by a cell.
std::vector<Eigen::Vector2d> rounded(const Polygon& polygon, int cell_px) {
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2i& corner : polygon) corners.emplace_back(corner.cast<double>());
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<Eigen::Vector2d> cut_corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d& from = corners[i];
      const Eigen::Vector2d side = corners[(i + 1) % corners.size()] - from;
      const double share = std::min(0.25, cell_px / std::max(1.0, side.norm()));
      cut_corners.emplace_back(from + share * side);
      cut_corners.emplace_back(from + (1 - share) * side);
    }
    corners = std::move(cut_corners);
  }
  return corners;
}

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kNearest_m = 1.5;  // closer, a line would cross the whole image

/// A frame as its camera sees it.
struct Eye {
  const RecordedDrive& drive;
  std::size_t frame;
  SE3 T_cam_world;

  std::vector<Vector2d> projected(const std::vector<Vector3d>& points_cam) const {
    std::vector<Vector2d> pixels;
    for (const auto& p_cam : points_cam) {
      if (!(p_cam.z() >= kNearest_m)) continue;
      if (const auto uvd_px = drive.camera.project(p_cam)) pixels.emplace_back(uvd_px->x(), uvd_px->y());
    }
    return pixels;
  }
  /// The part of a line that lies ahead; empty where none does.
  std::vector<Vector2d> projectedLine(Vector3d from_cam, Vector3d to_cam) const {
    if (from_cam.z() > to_cam.z()) std::swap(from_cam, to_cam);
    if (!(to_cam.z() >= kNearest_m)) return {};
    if (from_cam.z() < kNearest_m)
      from_cam += (kNearest_m - from_cam.z()) / (to_cam.z() - from_cam.z()) * (to_cam - from_cam);
    return projected({from_cam, to_cam});
  }
};

/// Draws lines on a photo with a dark rim, as they would be lost where it is bright.
void drawOnPhoto(Canvas& canvas, Canvas::Points points, const Pen& pen) {
  canvas.polyline(points, {.color = kDark, .width_px = pen.width_px + 2, .opacity = 0.4 * pen.opacity});
  canvas.polyline(points, pen);
}

Pen penOf(const ObjectEstimate& object, double width_px, double opacity = 1) {
  Pen pen{.color = trackColor(object.track), .width_px = width_px, .opacity = opacity};
  if (object.state == ObjectState::kPredicted) pen.dashes_px = {5, 4};
  return pen;
}

void drawBox(Sheet& sheet, const ObjectEstimate& object) {
  const Box& b = object.box;
  const std::array<Vector2d, 4> corners{
      {{b.left_px, b.top_px}, {b.right_px, b.top_px}, {b.right_px, b.bottom_px}, {b.left_px, b.bottom_px}}};
  const bool predicted = object.state == ObjectState::kPredicted;
  if (!sheet.note(predicted ? Mark::kPredicted : Mark::kBox, corners)) return;
  sheet.canvas.outline(corners, {.color = kDark, .width_px = 4, .opacity = 0.4});
  sheet.canvas.outline(corners, penOf(object, 2));
}

/// Draws the twelve edges, as far as the object was seen. Edges that it hides itself are thin; all are dashed if it is
/// only predicted.
void drawCuboid(Sheet& sheet, const Eye& eye, const ObjectEstimate& object, const SeenExtent& extent) {
  const SE3 T_cam_body = eye.T_cam_world * object.T_world_body;
  const Vector3d eye_body = T_cam_body.inverse().translation();
  const auto faceSeen = [&](int axis, bool upper) {
    return upper ? eye_body[axis] > extent.most_body[axis] : eye_body[axis] < extent.least_body[axis];
  };
  const auto corner = [&](int i) {
    const Eigen::Array3d upper(i & 1, i >> 1 & 1, i >> 2 & 1);
    return T_cam_body * Vector3d(extent.least_body.array() + upper * (extent.most_body - extent.least_body).array());
  };
  const Mark mark = object.state == ObjectState::kPredicted ? Mark::kPredicted : Mark::kCuboid;
  for (const bool front : {false, true}) {
    for (int from = 0; from < 8; ++from) {
      for (int axis = 0; axis < 3; ++axis) {
        const int to = from | 1 << axis, a = (axis + 1) % 3, b = (axis + 2) % 3;  // the edge's two faces
        if (to == from || front != (faceSeen(a, from >> a & 1) || faceSeen(b, from >> b & 1))) continue;
        const auto line = eye.projectedLine(corner(from), corner(to));
        if (!sheet.note(mark, line)) continue;
        drawOnPhoto(sheet.canvas, line, penOf(object, front ? 1.8 : 1, front ? 1 : 0.5));
      }
    }
  }
}

void drawPoints(Sheet& sheet, const std::vector<ObjectPoint>& points) {
  for (const ObjectPoint& point : points) {
    const std::array at{Vector2d(point.uvd_px.head<2>())};
    if (!sheet.note(Mark::kPoint, at)) continue;
    sheet.canvas.dot(at[0], 2.2, {kDark, 0.75});
    sheet.canvas.dot(at[0], 1.3, {lightened(lightened(trackColor(point.track))), 1});
  }
}

/// Draws the object's path on the ground below it, fading backwards.
void drawWay(Sheet& sheet, const Eye& eye, const ObjectEstimate& object, const Vector3d& bottom_body) {
  constexpr std::size_t kWay_frames = 20;
  const std::size_t earliest = eye.frame - std::min(eye.frame, kWay_frames);
  std::vector<Vector3d> way_cam;
  for (const auto& p_world : eye.drive.wayOf(object.track, bottom_body, earliest, eye.frame))
    way_cam.push_back(eye.T_cam_world * p_world);
  for (std::size_t i = 1; i < way_cam.size(); ++i) {
    const auto piece = eye.projectedLine(way_cam[i - 1], way_cam[i]);
    if (!sheet.note(Mark::kWay, piece)) continue;
    const double age = static_cast<double>(way_cam.size() - i) / kWay_frames;
    sheet.canvas.polyline(
        piece, {.color = trackColor(object.track), .width_px = 2.2, .opacity = 0.85 - 0.7 * std::min(age, 1.0)});
  }
}

void drawMotion(Sheet& sheet, const Eye& eye, const ObjectEstimate& object, const Vector3d& front_body) {
  if (object.state == ObjectState::kStopped) return;
  const Vector3d p_world = object.T_world_body * front_body;
  const auto ends = eye.projected({eye.T_cam_world * p_world, eye.T_cam_world * (p_world + object.velocity_world_mps)});
  if (ends.size() != 2 || !sheet.note(Mark::kMotion, ends)) return;
  sheet.canvas.arrow(ends[0], ends[1], {.color = kDark, .width_px = 4.5, .opacity = 0.45});
  sheet.canvas.arrow(ends[0], ends[1], {.color = trackColor(object.track), .width_px = 2.4});
}

std::string kindText(const ObjectEstimate& object) {
  if (!object.cuboid || object.cuboid->kind == ObjectKind::kUnknown) return "";
  std::string text(kindName(object.cuboid->kind));
  std::ranges::replace(text, '_', ' ');
  return " " + text;
}

/// Distance, and speed with its standard deviation, as far as they are numbers.
std::string factsText(const ObjectEstimate& object, double distance_m) {
  std::string text = std::isfinite(distance_m) ? fmt::format("{:.0f} m", distance_m) : "";
  if (object.state == ObjectState::kStopped) return text + " · stopped";
  const double speed_mps = object.velocity_world_mps.norm();
  if (!std::isfinite(speed_mps)) return text;
  text += fmt::format(" · {:.1f}", speed_mps);
  if (object.speed_sigma_mps > 0) text += fmt::format(" ±{:.1f}", object.speed_sigma_mps);
  return text + " m/s";
}

Rectangle boxOf(const ObjectEstimate& object) {
  const Box& b = object.box;
  return {b.left_px, b.top_px, std::max(0.0, b.right_px - b.left_px), std::max(0.0, b.bottom_px - b.top_px)};
}

void drawObject(Sheet& sheet, const Eye& eye, const ObjectEstimate& object) {
  const auto extent = seenExtent(eye.drive, eye.frame, object);
  const SeenExtent spread = extent.value_or(SeenExtent{Vector3d::Zero(), Vector3d::Zero()});
  Vector3d bottom_body = spread.middle_body();
  bottom_body.z() = spread.least_body.z();
  const Vector3d front_body(spread.most_body.x(), bottom_body.y(), bottom_body.z());
  drawWay(sheet, eye, object, bottom_body);
  if (object.cuboid && extent)
    drawCuboid(sheet, eye, object, *extent);
  else
    drawBox(sheet, object);
  drawMotion(sheet, eye, object, front_body);
}

/// Tints each object's pixels of a mask in the color of its track, with a crisp rim.
void paintMask(Sheet& sheet, const Gray16Image& mask) {
  constexpr double kInside = 0.3, kRim = 0.95;
  for (const auto& [value, bounds] : boundsByValue(mask)) {
    const Color color = trackColor(trackOfMask(value));
    const ObjectMask object = cut(mask, value, bounds);
    for (const Polygon& polygon : outlinePolygons(object, mask.width, mask.height)) {
      const auto corners = rounded(polygon, object.cell_px);
      sheet.note(Mark::kMask, corners);
      sheet.canvas.fill(corners, {color, kInside});
      sheet.canvas.outline(corners, {.color = color, .width_px = 1.2, .opacity = kRim});
    }
  }
}

}  // namespace

void paintImageView(Sheet& sheet, const DrawnImages& images, const RecordedDrive& drive, std::size_t frame) {
  if (images.mask) paintMask(sheet, *images.mask);
  if (frame >= drive.T_world_cam.size()) return;
  const Eye eye{drive, frame, drive.T_world_cam[frame].inverse()};
  std::vector<std::pair<double, const ObjectEstimate*>> by_distance;
  const auto objects = drive.objectsAt(frame);
  for (const auto& object : objects) {
    const double distance_m = (eye.T_cam_world * object.T_world_body.translation()).norm();
    by_distance.emplace_back(std::isnan(distance_m) ? std::numeric_limits<double>::infinity() : distance_m, &object);
  }
  std::ranges::stable_sort(by_distance, {}, [](const auto& entry) { return entry.first; });
  const std::vector farthest_first(by_distance.rbegin(), by_distance.rend());
  for (const auto& [distance_m, object] : farthest_first) drawObject(sheet, eye, *object);
  drawPoints(sheet, drive.pointsAt(frame));
  std::vector<Tag> tags;
  for (const auto& [distance_m, object] : by_distance) {
    const Rectangle box = boxOf(*object);
    if (!(sheet.area().overlap(box.grownBy(1)) > 0)) continue;
    tags.push_back({trackColor(object->track), fmt::format("#{}", object->track.value) + kindText(*object),
                    factsText(*object, distance_m), box});
  }
  paintTags(sheet, tags);
}

}  // namespace motorcade
