#include "apps/draw/image_view.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "io/mask_image.hpp"
#include "io/object_row.hpp"

namespace motorcade {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kNearest_m = 1.5;  // closer, a line would cross the whole image

std::vector<Vector2d> projected(const std::vector<Vector3d>& points_cam, const StereoCamera& camera) {
  std::vector<Vector2d> pixels;
  for (const auto& p_cam : points_cam) {
    if (p_cam.z() < kNearest_m) continue;
    if (const auto uvd_px = camera.project(p_cam)) pixels.emplace_back(uvd_px->x(), uvd_px->y());
  }
  return pixels;
}

/// The part of a line that lies ahead, in pixels; empty where none does.
std::vector<Vector2d> projectedLine(Vector3d from_cam, Vector3d to_cam, const StereoCamera& camera) {
  if (from_cam.z() > to_cam.z()) std::swap(from_cam, to_cam);
  if (to_cam.z() < kNearest_m) return {};
  if (from_cam.z() < kNearest_m)
    from_cam += (kNearest_m - from_cam.z()) / (to_cam.z() - from_cam.z()) * (to_cam - from_cam);
  return projected({from_cam, to_cam}, camera);
}

/// Translucent, in the colors of their tracks, with a brighter rim.
void drawMask(Canvas& canvas, const Gray16Image& mask) {
  constexpr double kInside = 0.32, kRim = 0.85;
  const auto at = [&](int x, int y) {
    return mask.pixels[static_cast<std::size_t>(std::clamp(y, 0, mask.height - 1)) * mask.width +
                       std::clamp(x, 0, mask.width - 1)];
  };
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const std::uint16_t value = at(x, y);
      if (value == 0) continue;
      const bool rim = at(x - 1, y) != value || at(x + 1, y) != value || at(x, y - 1) != value || at(x, y + 1) != value;
      canvas.blend(x, y, trackColor(trackOfMask(value)), rim ? kRim : kInside);
    }
  }
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

/// The twelve edges; those that the cuboid itself hides are thin, all are dashed where the object is only predicted.
void drawCuboid(Canvas& canvas, const StereoCamera& camera, const SE3& T_cam_body, const ObjectEstimate& object,
                Color color) {
  const ObjectBox& box = *object.cuboid;
  const Vector3d eye = (T_cam_body.inverse() * Vector3d(0, 0, 0) - box.center_body).cwiseQuotient(box.size_m);
  const auto faceSeen = [&](int axis, bool upper) { return upper ? eye[axis] > 0.5 : eye[axis] < -0.5; };
  const auto corner = [&](int i) {
    const Vector3d to_corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    return T_cam_body * (box.center_body + to_corner.cwiseProduct(box.size_m));
  };
  for (int from = 0; from < 8; ++from) {
    for (int axis = 0; axis < 3; ++axis) {
      const int to = from | 1 << axis;
      if (to == from) continue;
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;  // the edge's two faces
      const bool seen = faceSeen(a, from >> a & 1) || faceSeen(b, from >> b & 1);
      const auto line = projectedLine(corner(from), corner(to), camera);
      if (object.state == ObjectState::kPredicted)
        canvas.dashedPolyline(line, color, 1.5, 5, seen ? 1 : 0.5);
      else
        canvas.polyline(line, color, seen ? 2 : 1, seen ? 1 : 0.55);
    }
  }
}

void drawPoints(Canvas& canvas, const std::vector<ObjectPoint>& points) {
  constexpr double kSize_px = 2.6, kRim_px = 1.6;
  for (const ObjectPoint& point : points) {
    const Vector2d at = point.uvd_px.head<2>();
    canvas.line(at, at, {16, 18, 22}, kSize_px + kRim_px, 0.75);
    canvas.line(at, at, lightened(trackColor(point.track)), kSize_px);
  }
}

/// Way and motion on the ground.
void drawMotion(Canvas& canvas, const RecordedDrive& run, std::size_t frame, const ObjectEstimate& object) {
  constexpr std::size_t kWay_frames = 15;
  const Color color = trackColor(object.track);
  const SE3 T_cam_world = run.T_world_cam[frame].inverse();
  const ObjectBox box = object.cuboid.value_or(ObjectBox{});
  const Vector3d bottom_body = box.center_body - Vector3d(0, 0, 0.5 * box.size_m.z()),
                 front_body = bottom_body + Vector3d(0.5 * box.size_m.x(), 0, 0);
  std::vector<Vector3d> way_cam;
  const std::size_t earliest = frame - std::min(frame, kWay_frames);
  for (const auto& p_world : run.wayOf(object.track, bottom_body, earliest, frame))
    way_cam.push_back(T_cam_world * p_world);
  canvas.polyline(projected(way_cam, run.camera), color, 2, 0.6);
  if (object.state != ObjectState::kMoving) return;
  const Vector3d p_world = object.T_world_body * front_body;
  const auto ends = projected({T_cam_world * p_world, T_cam_world * (p_world + object.velocity_world_mps)}, run.camera);
  if (ends.size() == 2) canvas.arrow(ends[0], ends[1], color, 2.5);
}

std::string kindText(const ObjectEstimate& object) {
  if (!object.cuboid || object.cuboid->kind == ObjectKind::kUnknown) return "";
  std::string text(kindName(object.cuboid->kind));
  std::ranges::replace(text, '_', ' ');
  return " " + text;
}

/// A line of text on a plate of the object's color.
struct Tag {
  static constexpr double kPad_px = 3, kHeight_px = 14;
  std::string text;
  Color color;
  Vector2d corner;  // of the object's box, to which the tag belongs
  Vector2d at;      // upper left corner of the text
  Vector2d least() const { return at - Vector2d(kPad_px, kPad_px); }
  Vector2d most() const { return at + Vector2d(Canvas::textWidth(text) + kPad_px - 1, kHeight_px + kPad_px - 1); }
  bool overlaps(const Tag& other) const {
    return (least().array() <= other.most().array()).all() && (other.least().array() <= most().array()).all();
  }
};

Tag tagOf(const ObjectEstimate& object, double distance_m, int image_width_px) {
  constexpr double kSmall_px = 32;  // objects that are lower than this in the image have no room for more
  Tag tag{.text = format("#%lld", static_cast<long long>(object.track.value)),
          .color = trackColor(object.track),
          .corner = {object.box.left_px, object.box.top_px},
          .at = {}};
  const bool small = object.box.bottom_px - object.box.top_px < kSmall_px;
  if (!small) tag.text += kindText(object);
  tag.text += format(" %.0f m", distance_m);
  if (!small) tag.text += format(" %.1f m/s", object.velocity_world_mps.norm());
  const double most_px = image_width_px - Canvas::textWidth(tag.text) - 2 * Tag::kPad_px;
  tag.at = {std::clamp(tag.corner.x() + 2, Tag::kPad_px, std::max(Tag::kPad_px, most_px)),
            tag.corner.y() - Tag::kHeight_px - 2 * Tag::kPad_px};
  return tag;
}

/// One above the other where they would overlap, the lowest in the image first.
void drawTags(Canvas& canvas, std::vector<Tag> tags) {
  constexpr double kStep_px = 4, kLeader_px = 8;
  std::ranges::sort(tags, std::ranges::greater{}, [](const Tag& tag) { return tag.at.y(); });
  for (std::size_t i = 0; i < tags.size(); ++i) {
    Tag& tag = tags[i];
    const auto hidden = [&](const Tag& other) { return tag.overlaps(other); };
    while (tag.least().y() > kStep_px &&
           std::any_of(tags.begin(), tags.begin() + static_cast<std::ptrdiff_t>(i), hidden))
      tag.at.y() -= kStep_px;
    tag.at.y() = std::max(tag.at.y(), Tag::kPad_px + 1);
    if (tag.corner.y() - tag.most().y() > kLeader_px)
      canvas.line({tag.corner.x() + 1, tag.most().y()}, tag.corner + Vector2d(1, 0), tag.color, 1.5);
  }
  for (const Tag& tag : tags) {
    const Vector2d least = tag.least(), most = tag.most();
    canvas.fillPolygon({least, {most.x(), least.y()}, most, {least.x(), most.y()}}, tag.color, 0.92);
    canvas.text(tag.at, tag.text, {12, 14, 18});
  }
}

}  // namespace

Canvas drawImageView(const DrawnImages& images, const RecordedDrive& run, std::size_t frame) {
  Canvas canvas(images.left);
  if (images.mask) drawMask(canvas, *images.mask);
  const SE3 T_cam_world = run.T_world_cam[frame].inverse();
  const auto objects = run.objectsAt(frame);
  std::multimap<double, const ObjectEstimate*, std::greater<>> by_distance_m;  // the nearest over the others
  for (const auto& object : objects)
    by_distance_m.emplace((T_cam_world * object.T_world_body.translation()).norm(), &object);
  std::vector<Tag> tags;
  for (const auto& [distance_m, found] : by_distance_m) {
    const ObjectEstimate& object = *found;
    drawMotion(canvas, run, frame, object);
    if (object.cuboid)
      drawCuboid(canvas, run.camera, T_cam_world * object.T_world_body, object, trackColor(object.track));
    else
      drawBox(canvas, object, trackColor(object.track));
    tags.push_back(tagOf(object, distance_m, canvas.width()));
  }
  drawPoints(canvas, run.pointsAt(frame));
  drawTags(canvas, std::move(tags));
  return canvas;
}

}  // namespace motorcade
