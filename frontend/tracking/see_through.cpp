#include "frontend/tracking/see_through.hpp"

#include <algorithm>
#include <vector>

#include "frontend/tracking/object_motion.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {

std::optional<PointRegion> regionOf(std::span<const ScenePoint* const> points) {
  if (points.empty()) return std::nullopt;
  PointRegion region{{1e9, 1e9, -1e9, -1e9}, 0};
  std::vector<double> disparities_px;
  for (const ScenePoint* p : points) {
    region.box.left_px = std::min(region.box.left_px, p->uvd_px.x());
    region.box.right_px = std::max(region.box.right_px, p->uvd_px.x());
    region.box.top_px = std::min(region.box.top_px, p->uvd_px.y());
    region.box.bottom_px = std::max(region.box.bottom_px, p->uvd_px.y());
    disparities_px.push_back(p->uvd_px.z());
  }
  const auto middle = disparities_px.begin() + std::ssize(disparities_px) / 2;
  std::ranges::nth_element(disparities_px, middle);
  region.disparity_px = *middle;
  return region;
}

/// The road at the depth of the two does not count: it is seen between the wheels of a car as well.
bool isSeenThrough(const SceneMotion& scene, const PointRegion& a, const PointRegion& b, const StereoCamera& camera) {
  constexpr double kLeastGap_px = 6;  // half a patch: points that are nearer share pixels
  constexpr double kBehind_m = 1;     // the line between the two: more than a person is deep
  constexpr int kLeastBehind = 3;     // points, as one or two may have wrong disparities
  constexpr double kMost = 0.7;       // of the points between
  const auto& [left, left_px] = a.box.left_px < b.box.left_px ? a : b;
  const auto& [right, right_px] = a.box.left_px < b.box.left_px ? b : a;
  const double gap_px = right.left_px - left.right_px, fb = camera.fx_px * camera.baseline_m;
  if (gap_px < kLeastGap_px) return false;
  int behind = 0, between = 0;
  for (const ScenePoint& p : scene.points) {
    const double u_px = p.uvd_px.x(), v_px = p.uvd_px.y(), share = (u_px - left.right_px) / gap_px;
    if (share <= 0 || share >= 1) continue;
    const auto at = [share](double at_left, double at_right) { return at_left + share * (at_right - at_left); };
    if (v_px < at(left.top_px, right.top_px) || v_px > at(left.bottom_px, right.bottom_px)) continue;
    const double line_px = at(left_px, right_px);
    if (fb / p.uvd_px.z() > fb / line_px + kBehind_m)
      ++behind;
    else if (p.label != PointLabel::kGround)
      ++between;
  }
  return behind >= kLeastBehind && behind > kMost * (behind + between);
}

std::optional<PointRegion> SeeThrough::regionOf(const TrackedObject& object) const {
  return mayBeSmall(object) ? seenRegionOf(object) : std::nullopt;
}

std::optional<PointRegion> SeeThrough::seenRegionOf(const TrackedObject& object) const {
  std::vector<const ScenePoint*> points;
  for (const BodyPoint& p : object.points)
    if (const ScenePoint* seen = findPoint(scene_, p.point)) points.push_back(seen);
  return motorcade::regionOf(points);
}

bool SeeThrough::areApart(const TrackedObject& a, const TrackedObject& b) const {
  const auto of_a = regionOf(a), of_b = of_a ? regionOf(b) : std::nullopt;
  return of_b && isSeenThrough(scene_, *of_a, *of_b, camera_);
}

bool SeeThrough::isGapBetween(const TrackedObject& a, const TrackedObject& b) const {
  const auto of_a = seenRegionOf(a), of_b = of_a ? seenRegionOf(b) : std::nullopt;
  return of_b && isSeenThrough(scene_, *of_a, *of_b, camera_);
}

bool SeeThrough::isApart(const TrackedObject& object, const MotionComponent& component) const {
  const auto own = regionOf(object);
  if (!own) return false;
  std::vector<const ScenePoint*> points;
  for (const int i : component.points) points.push_back(&scene_.points[i]);
  const auto other = motorcade::regionOf(points);
  return other && isSeenThrough(scene_, *own, *other, camera_);
}

}  // namespace motorcade
