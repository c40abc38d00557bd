#include "frontend/tracking/trunk_windows.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "frontend/tracking/search_by_projection.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

constexpr double kHip_m = 0.7, kHead_m = 1.8;  // heights over the road between which a window lies
constexpr double kHalfWidth_m = 0.3;
constexpr double kKnee_m = 0.5;  // height over the road above which points tell of a trunk

/// Column of the image in which a window was looked for. Other points there, at any height, have the same one.
struct Column {
  double u_px, disparity_px, reach_m, reach_px;
};

}  // namespace

bool standsOut(const Box& box, double disparity_px, const SceneMotion& scene, int most_patches) {
  constexpr double kMargin_px = 4, kLeastWide_px = 12;
  constexpr double kLeastInside = 0.3, kMostBeside = 0.5;  // of the share inside: clothes may be smooth
  const double wide_px = std::max(kLeastWide_px, 0.5 * (box.right_px - box.left_px));
  Box left = box, right = box;
  left.right_px = box.left_px - kMargin_px, left.left_px = left.right_px - wide_px;
  right.left_px = box.right_px + kMargin_px, right.right_px = right.left_px + wide_px;
  const auto share = [&](const Box& part) {
    return shareAtDepth(*scene.features, part, disparity_px, scene.disparity_offset_px, most_patches);
  };
  const double own = share(box);
  return own > kLeastInside && share(left) < kMostBeside * own && share(right) < kMostBeside * own;
}

std::vector<TrunkWindow> TrunkWindows::operator()(const SceneMotion& scene, const std::vector<bool>& on_objects,
                                                  const SE3& T_world_cam) const {
  constexpr std::size_t kMost = 16;  // each takes a millisecond more
  std::vector<TrunkWindow> windows;
  std::vector<Column> looked_at;
  for (int i = 0; i < static_cast<int>(scene.points.size()) && windows.size() < kMost; ++i) {
    const ScenePoint& point = scene.points[i];
    const double disparity_px = point.uvd_px.z(), px_per_m = disparity_px / camera_.baseline_m;
    const auto isThere = [&](const Column& column) {
      return std::abs(column.u_px - point.uvd_px.x()) < column.reach_m * px_per_m &&
             std::abs(column.disparity_px - disparity_px) < column.reach_px;
    };
    if (on_objects[i] || point.instance != 0 || !mayBeOnTrunk(point, scene.ground)) continue;
    if (std::ranges::any_of(looked_at, isThere)) continue;
    looked_at.push_back({point.uvd_px.x(), disparity_px, 0.1, 1});
    for (const double aside_m : {0.0, -0.2, 0.2}) {
      const Box box = boxAround(point, aside_m, scene.ground);
      auto pixels = moving(box, disparity_px, scene, T_world_cam);
      if (!pixels) continue;
      looked_at.back() = {pixels->middle_px.x(), disparity_px, kHalfWidth_m, 2};
      windows.push_back({i, box, std::move(*pixels)});
      break;
    }
  }
  return windows;
}

/// Pixels of a box that stands out and does not rest.
std::optional<RegionPixels> TrunkWindows::moving(const Box& box, double disparity_px, const SceneMotion& scene,
                                                 const SE3& T_world_cam) const {
  constexpr int kFew = 60, kFewPatches = 16;  // pixels and patches: enough to leave out most boxes
  if (!camera_.inLeftImage(box.left_px, box.top_px) || !camera_.inLeftImage(box.right_px, box.bottom_px))
    return std::nullopt;
  if (flow_.rests(pixelsIn(box, kFew), disparity_px, scene, T_world_cam)) return std::nullopt;
  if (!standsOut(box, disparity_px, scene, kFewPatches)) return std::nullopt;
  RegionPixels pixels = pixelsAtDepth(box, disparity_px, scene);
  if (flow_.rests(pixels, disparity_px, scene, T_world_cam)) return std::nullopt;
  return pixels;
}

/// True for a point between knee and head of what may walk, if it is not where it would be at rest.
bool TrunkWindows::mayBeOnTrunk(const ScenePoint& point, const GroundPlane& ground) const {
  constexpr double kNearest_m = 5, kWalk_mps = 1.4;
  const bool moved = point.age > 1 && !point.ego_inlier && !point.ambiguous;
  if (!moved || point.label == PointLabel::kGround || point.uvd_px.z() <= 0) return false;
  const Eigen::Vector3d p_cam = camera_.triangulate(point.uvd_px);
  const double height_m = ground.heightOf_m(p_cam);
  return p_cam.z() > kNearest_m && isWalk(kWalk_mps, p_cam.z(), camera_) && height_m > kKnee_m && height_m < kHead_m;
}

Box TrunkWindows::boxAround(const ScenePoint& point, double aside_m, const GroundPlane& ground) const {
  const double px_per_m = point.uvd_px.z() / camera_.baseline_m;
  const double height_m = ground.heightOf_m(camera_.triangulate(point.uvd_px));
  const double middle_px = point.uvd_px.x() + aside_m * px_per_m, half_px = kHalfWidth_m * px_per_m;
  const double px_per_m_down = px_per_m * camera_.fy_px / camera_.fx_px;
  return {middle_px - half_px, point.uvd_px.y() - (kHead_m - height_m) * px_per_m_down, middle_px + half_px,
          point.uvd_px.y() + (height_m - kHip_m) * px_per_m_down};
}

}  // namespace motorcade
