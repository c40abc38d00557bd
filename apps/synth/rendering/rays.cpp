#include "apps/synth/rendering/rays.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade::synth {
namespace {

constexpr float kNear_m = 0.05F;  // nothing comes closer to the camera

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3 centerOf(const Primitive& part) { return (part.lo + part.hi) * 0.5F; }
Vec3 halfOf(const Primitive& part) { return (part.hi - part.lo) * 0.5F; }

/// Names the face: which way the normal points, roughly.
std::uint32_t faceOf(const Vec3& n) {
  const auto step = [](float x) { return static_cast<std::uint32_t>(std::lround(2 * x) + 2); };
  return step(n.x) + 5 * step(n.y) + 25 * step(n.z);
}

/// The numbers u for which the plane x = u z touches the ellipsoid: (x - u z)^2 = xx - 2 u xz + u^2 zz. Its center is
/// (x, z), its second moments are xx, xz, zz. Stored are half their difference and their middle.
struct Tangents {
  float middle, half;
};
Tangents tangents(float x, float z, float xx, float xz, float zz) {
  const float a = z * z - zz, b = x * z - xz, c = x * x - xx;
  return {b / a, std::sqrt(std::fmax(0.0F, b * b - a * c)) / a};
}

/// Room for rounding.
Covered widened(Covered c, float margin) {
  c.left -= margin;
  c.top -= margin;
  c.right += margin;
  c.bottom += margin;
  c.near -= 1e-3F + 1e-5F * std::abs(c.near);
  c.far += 1e-3F + 1e-5F * std::abs(c.far);
  return c;
}

}  // namespace

std::optional<RayHit> hitPart(const FrameScene& frame, std::uint32_t item, const Vec3& origin_body,
                              const Vec3& direction_body, const RayRange& range) {
  const Placed& placed = frame.placedOf(item);
  const Primitive& part = frame.partOf(item);
  const auto hit = intersect(part, placed.model->cuts.data(), origin_body, direction_body, range.from, range.to);
  if (!hit) return std::nullopt;
  const bool round = part.shape != Shape::kBlock;
  return RayHit{hit->t,      &placed,
                &part,       item * 128U + (round ? 0U : faceOf(hit->normal)),
                hit->normal, origin_body + direction_body * hit->t};
}

CameraRays::CameraRays(const FrameScene& frame, const StereoCamera& camera, StereoSide side, float beyond_px)
    : frame_(frame),
      cx_px_(static_cast<float>(camera.cx_px)),
      cy_px_(static_cast<float>(camera.cy_px)),
      pixel_x_(static_cast<float>(1 / camera.fx_px)),
      pixel_y_(static_cast<float>(1 / camera.fy_px)) {
  const auto& R = frame.T_map_cam().rotation();
  const auto column = [&](int i) {
    return Vec3{static_cast<float>(R(0, i)), static_cast<float>(R(1, i)), static_cast<float>(R(2, i))};
  };
  right_ = column(0);
  down_ = column(1);
  ahead_ = column(2);
  if (side == StereoSide::kRight) origin_ = right_ * static_cast<float>(camera.baseline_m);
  for (const auto& placed : frame.placed())
    origins_body_.push_back(placed.rotation.transposed(origin_ - placed.translation));
  std::vector<Covered> all;
  for (std::uint32_t i = 0; i < frame.items().size(); ++i) {
    const Covered covered = coveredBy(i);
    if (covered.far > kNear_m) all.push_back(covered);
  }
  constexpr float kCell_px = 12;
  const float border_px = 1 + beyond_px;
  grid_.emplace(std::move(all),
                ItemGrid::Area{-border_px, -border_px, static_cast<float>(camera.width_px) + border_px,
                               static_cast<float>(camera.height_px) + border_px},
                kCell_px);
}

Covered CameraRays::coveredBy(std::uint32_t item) const {
  const Placed& placed = frame_.placedOf(item);
  const Primitive& part = frame_.partOf(item);
  const auto round = part.shape == Shape::kEllipsoid ? coveredByEllipsoid(part, placed) : std::nullopt;
  Covered covered = widened(round ? *round : coveredByBox(part, placed), 0.05F);
  covered.item = item;
  return covered;
}

Covered CameraRays::coveredByBox(const Primitive& part, const Placed& placed) const {
  std::array<Vec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i) {
    const Vec3 p{(i & 1U) != 0 ? part.hi.x : part.lo.x, (i & 2U) != 0 ? part.hi.y : part.lo.y,
                 (i & 4U) != 0 ? part.hi.z : part.lo.z};
    const Vec3 q = placed.rotation * p + placed.translation - origin_;
    corners[i] = {dot(q, right_), dot(q, down_), dot(q, ahead_)};
  }
  Covered covered;
  const auto include = [&](const Vec3& p) {
    covered.include(p.x / (p.z * pixel_x_) + cx_px_, p.y / (p.z * pixel_y_) + cy_px_, p.z);
  };
  for (unsigned i = 0; i < 8; ++i) {
    if (corners[i].z >= kNear_m) include(corners[i]);
    for (const unsigned bit : {1U, 2U, 4U}) {
      const Vec3 &a = corners[i & ~bit], &b = corners[i | bit];
      if ((i & bit) == 0 && (a.z < kNear_m) != (b.z < kNear_m)) {
        Vec3 p = a + (b - a) * ((kNear_m - a.z) / (b.z - a.z));
        p.z = kNear_m;
        include(p);
      }
    }
  }
  return covered;
}

std::optional<Covered> CameraRays::coveredByEllipsoid(const Primitive& part, const Placed& placed) const {
  const Vec3 q = placed.rotation * centerOf(part) + placed.translation - origin_, half = halfOf(part);
  const auto axis = [&](const Vec3& a) { return placed.rotation.transposed(a) * half; };
  const Vec3 x = axis(right_), y = axis(down_), z = axis(ahead_);
  const float depth = dot(q, ahead_), reach = norm(z);
  if (depth - reach < kNear_m) return std::nullopt;
  const Tangents across = tangents(dot(q, right_), depth, dot(x, x), dot(x, z), dot(z, z)),
                 down = tangents(dot(q, down_), depth, dot(y, y), dot(y, z), dot(z, z));
  Covered covered;
  for (const float side : {-1.0F, 1.0F})
    covered.include((across.middle + side * across.half) / pixel_x_ + cx_px_,
                    (down.middle + side * down.half) / pixel_y_ + cy_px_, depth + side * reach);
  return covered;
}

std::optional<RayHit> CameraRays::firstHit(float u_px, float v_px, const Vec3& direction, float t_max) const {
  std::optional<RayHit> best;
  grid_->traverse(u_px, v_px, 0, t_max, [&](std::uint32_t item, float limit) {
    const auto hit = hitPart(frame_, item, origins_body_[frame_.items()[item].placed],
                             frame_.placedOf(item).rotation.transposed(direction), {1e-3F, limit});
    if (!hit) return limit;
    best = hit;
    return hit->t;
  });
  return best;
}

ParallelRays::ParallelRays(const FrameScene& frame, const Vec3& direction) : frame_(frame), direction_(direction) {
  right_ = normalized(cross(direction, std::abs(direction.x) < 0.7F ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  down_ = cross(direction, right_);
  for (const auto& placed : frame.placed()) directions_body_.push_back(placed.rotation.transposed(direction));
  std::vector<Covered> all;
  Covered bounds;
  for (std::uint32_t i = 0; i < frame.items().size(); ++i) {
    all.push_back(coveredBy(i));
    bounds.include(all.back().left, all.back().top, all.back().near);
    bounds.include(all.back().right, all.back().bottom, all.back().far);
  }
  constexpr float kCell_m = 1;
  if (!all.empty())
    grid_.emplace(std::move(all), ItemGrid::Area{bounds.left, bounds.top, bounds.right, bounds.bottom}, kCell_m);
}

Covered ParallelRays::coveredBy(std::uint32_t item) const {
  const Placed& placed = frame_.placedOf(item);
  const Primitive& part = frame_.partOf(item);
  const Vec3 center = placed.rotation * centerOf(part) + placed.translation, half = halfOf(part);
  const auto reach = [&](const Vec3& axis) {
    const Vec3 a = placed.rotation.transposed(axis) * half;
    return part.shape == Shape::kEllipsoid ? norm(a) : std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
  };
  const float x = reach(right_), y = reach(down_), z = reach(direction_);
  Covered covered;
  for (const float side : {-1.0F, 1.0F})
    covered.include(dot(center, right_) + side * x, dot(center, down_) + side * y, dot(center, direction_) + side * z);
  covered = widened(covered, 1e-3F);
  covered.item = item;
  return covered;
}

bool ParallelRays::occluded(const Vec3& origin, float t_max) const {
  if (!grid_) return false;
  const float from = dot(origin, direction_);
  bool blocked = false;
  grid_->traverse(dot(origin, right_), dot(origin, down_), from, from + t_max, [&](std::uint32_t item, float limit) {
    const Placed& placed = frame_.placedOf(item);
    const Vec3 o = placed.rotation.transposed(origin - placed.translation);
    const Vec3& d = directions_body_[frame_.items()[item].placed];
    blocked = intersect(frame_.partOf(item), placed.model->cuts.data(), o, d, 1e-4F, t_max).has_value();
    return blocked ? from - 1e6F : limit;
  });
  return blocked;
}

LensErrors::LensErrors(const StereoCamera& camera, StereoSide side, const CalibrationErrors& errors)
    : camera_(camera), side_(side), errors_(errors.data()) {}

/// Uses observations of a point far away: the right camera's error beyond the left one's is that of the disparity.
LensErrors::Pixel LensErrors::exact(float u_px, float v_px) const {
  if (errors_.isZero()) return {u_px, v_px};
  const Eigen::Vector3d shift = observationShifts(camera_, CalibrationSigmas{}, {u_px, v_px, 0}) * errors_;
  const double du_px = side_ == StereoSide::kLeft ? shift.x() : shift.x() - shift.z();
  return {u_px + static_cast<float>(du_px), v_px + static_cast<float>(shift.y())};
}

float LensErrors::beyond_px() const {
  float beyond_px = 0;
  for (const float u_px : {0.0F, static_cast<float>(camera_.width_px)}) {
    for (const float v_px : {0.0F, static_cast<float>(camera_.height_px)}) {
      const Pixel corner = exact(u_px, v_px);
      beyond_px = std::max({beyond_px, std::abs(corner.u_px - u_px), std::abs(corner.v_px - v_px)});
    }
  }
  return beyond_px;
}

}  // namespace motorcade::synth
