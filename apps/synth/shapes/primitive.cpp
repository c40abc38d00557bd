#include "apps/synth/shapes/primitive.hpp"

#include <array>
#include <numbers>

#include "apps/synth/shapes/noise.hpp"

namespace motorcade::synth {
namespace {

Vec3 axisVector(int axis, float sign) {
  Vec3 v;
  v[axis] = sign;
  return v;
}

/// Clips the ray against slabs and cuts; the last plane entered gives the normal.
std::optional<SurfaceHit> intersectBlock(const Primitive& part, const Cut* cuts, const Vec3& o, const Vec3& d,
                                         float t_min, float t_max) {
  float enter = -1e30F, leave = t_max;
  Vec3 normal;
  for (int axis = 0; axis < 3; ++axis) {
    const float inverse = 1 / (std::abs(d[axis]) < 1e-12F ? 1e-12F : d[axis]);
    const float sign = inverse > 0 ? -1.0F : 1.0F;
    const float near = ((inverse > 0 ? part.lo[axis] : part.hi[axis]) - o[axis]) * inverse;
    const float far = ((inverse > 0 ? part.hi[axis] : part.lo[axis]) - o[axis]) * inverse;
    if (near > enter) {
      enter = near;
      normal = axisVector(axis, sign);
    }
    leave = std::min(leave, far);
    if (enter >= leave) return std::nullopt;
  }
  for (int i = 0; i < part.cuts; ++i) {
    const Cut& cut = cuts[part.first_cut + i];
    const float speed = dot(cut.normal, d), distance = cut.offset - dot(cut.normal, o);
    if (std::abs(speed) < 1e-12F) {
      if (distance < 0) return std::nullopt;
    } else if (speed > 0) {
      leave = std::min(leave, distance / speed);
    } else if (distance / speed > enter) {
      enter = distance / speed;
      normal = cut.normal;
    }
    if (enter >= leave) return std::nullopt;
  }
  if (enter <= t_min) return std::nullopt;
  return SurfaceHit{enter, normal};
}

/// A crown has holes between its twigs and leaves, more of them towards its rim.
bool leafAt(const Vec3& p, const Vec3& unit_position, const Vec3& unit_direction, std::uint32_t seed) {
  const float facing = std::abs(dot(unit_position, unit_direction)) / norm(unit_direction);
  const float fine = noise3(p.x * 7.3F, p.y * 7.3F, p.z * 7.3F, seed + 1),
              coarse = noise3(p.x * 2.7F, p.y * 2.7F, p.z * 2.7F, seed);
  return 0.8F * coarse + 0.8F * fine > 0.42F - 0.75F * facing;
}

std::optional<SurfaceHit> intersectEllipsoid(const Primitive& part, const Vec3& o, const Vec3& d, float t_min,
                                             float t_max) {
  const Vec3 center = (part.lo + part.hi) * 0.5F, radii = (part.hi - part.lo) * 0.5F;
  const Vec3 scale{1 / radii.x, 1 / radii.y, 1 / radii.z};
  const Vec3 so = (o - center) * scale, sd = d * scale;
  const float a = dot(sd, sd), b = dot(so, sd);
  // Distance of the center from the ray first: b^2 - a c cancels badly for far spheres.
  const Vec3 nearest = so - sd * (b / a);
  const float rest = 1 - dot(nearest, nearest);
  if (rest < 0) return std::nullopt;
  const float half = std::sqrt(rest / a);
  for (const float t : {-b / a - half, -b / a + half}) {
    if (t <= t_min || t >= t_max) continue;
    const Vec3 p = o + d * t;
    const float twigs = part.material == Material::kLeaves ? 1.0F : part.material == Material::kFoliage ? 1.9F : 0;
    if (twigs > 0 && !leafAt(p * twigs, so + sd * t, sd, part.seed)) continue;
    const Vec3 normal = normalized((p - center) * scale * scale);
    return SurfaceHit{t, dot(normal, d) > 0 ? normal * -1 : normal};
  }
  return std::nullopt;
}

std::optional<SurfaceHit> intersectCylinder(const Primitive& part, const Vec3& o, const Vec3& d, float t_min,
                                            float t_max) {
  const int k = part.axis, i = (k + 1) % 3, j = (k + 2) % 3;
  const Vec3 center = (part.lo + part.hi) * 0.5F, radii = (part.hi - part.lo) * 0.5F;
  const float oi = (o[i] - center[i]) / radii[i], oj = (o[j] - center[j]) / radii[j];
  const float di = d[i] / radii[i], dj = d[j] / radii[j];
  const float a = std::max(di * di + dj * dj, 1e-20F), b = oi * di + oj * dj;
  const float ni = oi - di * (b / a), nj = oj - dj * (b / a);
  const float rest = 1 - ni * ni - nj * nj;
  if (rest < 0) return std::nullopt;
  const float half = std::sqrt(rest / a);
  const float side = -b / a - half, side_leave = -b / a + half;
  const float inverse = 1 / (std::abs(d[k]) < 1e-12F ? 1e-12F : d[k]);
  const float cap = ((inverse > 0 ? part.lo[k] : part.hi[k]) - o[k]) * inverse;
  const float cap_leave = ((inverse > 0 ? part.hi[k] : part.lo[k]) - o[k]) * inverse;
  const float enter = std::max(side, cap);
  if (enter >= std::min(side_leave, cap_leave) || enter <= t_min || enter >= t_max) return std::nullopt;
  if (cap > side) return SurfaceHit{enter, axisVector(k, inverse > 0 ? -1.0F : 1.0F)};
  Vec3 normal;
  normal[i] = (oi + di * enter) / radii[i];
  normal[j] = (oj + dj * enter) / radii[j];
  return SurfaceHit{enter, normalized(normal)};
}

/// The same cylinder as a ring: a ray that enters it where the hole is meets the hole's far wall, or nothing.
std::optional<SurfaceHit> intersectRing(const Primitive& part, const Vec3& o, const Vec3& d, float t_min, float t_max) {
  auto hit = intersectCylinder(part, o, d, t_min, t_max);
  const int i = (part.axis + 1) % 3, j = (part.axis + 2) % 3;
  if (!hit || std::abs(hit->normal[part.axis]) < 0.5F) return hit;
  const Vec3 center = (part.lo + part.hi) * 0.5F, radii = (part.hi - part.lo) * (0.5F * part.hole);
  const Vec3 p = o + d * hit->t - center;
  const float x = p[i] / radii[i], y = p[j] / radii[j], dx = d[i] / radii[i], dy = d[j] / radii[j];
  const float c = x * x + y * y - 1;
  if (c >= 0) return hit;
  const float a = std::fmax(dx * dx + dy * dy, 1e-20F), b = x * dx + y * dy;
  const float on = (std::sqrt(b * b - a * c) - b) / a;
  const Vec3 wall = p + d * on;
  if (hit->t + on >= t_max || std::abs(wall[part.axis]) > 0.5F * (part.hi[part.axis] - part.lo[part.axis]))
    return std::nullopt;
  Vec3 inwards;
  inwards[i] = -wall[i] / (radii[i] * radii[i]);
  inwards[j] = -wall[j] / (radii[j] * radii[j]);
  return SurfaceHit{hit->t + on, normalized(inwards)};
}

/// Common point of three planes, if there is one.
std::optional<Vec3> corner(const Cut& a, const Cut& b, const Cut& c) {
  const auto cross = [](const Vec3& u, const Vec3& v) {
    return Vec3{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  };
  const float det = dot(a.normal, cross(b.normal, c.normal));
  if (std::abs(det) < 1e-5F) return std::nullopt;
  return (cross(b.normal, c.normal) * a.offset + cross(c.normal, a.normal) * b.offset +
          cross(a.normal, b.normal) * c.offset) *
         (1 / det);
}

std::vector<Vec3> blockCorners(const Primitive& part, const Cut* cuts) {
  std::vector<Cut> planes(cuts + part.first_cut, cuts + part.first_cut + part.cuts);
  for (int axis = 0; axis < 3; ++axis) {
    planes.push_back({axisVector(axis, 1), part.hi[axis]});
    planes.push_back({axisVector(axis, -1), -part.lo[axis]});
  }
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const auto p = corner(planes[i], planes[j], planes[k]);
        if (!p) continue;
        const bool outside = std::any_of(planes.begin(), planes.end(),
                                         [&](const Cut& c) { return dot(c.normal, *p) > c.offset + 1e-4F; });
        if (!outside) corners.push_back(*p);
      }
  return corners;
}

/// Points on a circle just large enough to contain it between them.
constexpr int kCirclePoints = 24;
std::array<float, 2> circlePoint(int i) {
  const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kCirclePoints;
  const float reach = 1 / std::cos(std::numbers::pi_v<float> / kCirclePoints);
  return {reach * std::cos(angle), reach * std::sin(angle)};
}

}  // namespace

Primitive& Model::add(Material material, const Vec3& lo, const Vec3& hi, float tone, std::uint32_t seed) {
  Primitive part;
  part.material = material;
  part.lo = min(lo, hi);
  part.hi = max(lo, hi);
  part.tone = tone;
  part.seed = seed;
  part.first_cut = static_cast<std::uint16_t>(cuts.size());
  return parts.emplace_back(part);
}

Primitive& Model::addCylinder(Material material, int axis, const Vec3& lo, const Vec3& hi, float tone,
                              std::uint32_t seed) {
  Primitive& part = add(material, lo, hi, tone, seed);
  part.shape = Shape::kCylinder;
  part.axis = static_cast<std::uint8_t>(axis);
  return part;
}

Primitive& Model::addEllipsoid(Material material, const Vec3& center, const Vec3& radii, float tone,
                               std::uint32_t seed) {
  Primitive& part = add(material, center - radii, center + radii, tone, seed);
  part.shape = Shape::kEllipsoid;
  return part;
}

void Model::cutLast(const Vec3& normal, const Vec3& point) {
  const Vec3 n = normalized(normal);
  cuts.push_back({n, dot(n, point)});
  ++parts.back().cuts;
}

Primitive& Model::addBar(Material material, const Vec3& from, const Vec3& to, float thickness, float tone) {
  const Vec3 half{0.5F * thickness, 0.5F * thickness, 0.5F * thickness};
  add(material, min(from, to) - half, max(from, to) + half, tone);
  const Vec3 across = normalized({from.z - to.z, 0, to.x - from.x});
  for (const float side : {-0.5F, 0.5F}) cutLast(across * side, from + across * (side * thickness));
  return parts.back();
}

void Model::addLimb(Model limb, std::function<Limb::Pose(double driven_m)> pose) {
  limbs.push_back({std::make_shared<const Model>(std::move(limb)), std::move(pose)});
}

SE3 Limb::T_parent_limb(double driven_m) const {
  const Pose at = pose(driven_m);
  return {expSO3({0, at.angle_rad, 0}), Eigen::Vector3d(at.joint.x, at.joint.y, at.joint.z)};
}

std::optional<SurfaceHit> intersect(const Primitive& part, const Cut* cuts, const Vec3& origin, const Vec3& direction,
                                    float t_min, float t_max) {
  switch (part.shape) {
    case Shape::kBlock:
      return intersectBlock(part, cuts, origin, direction, t_min, t_max);
    case Shape::kCylinder:
      return part.hole > 0 ? intersectRing(part, origin, direction, t_min, t_max)
                           : intersectCylinder(part, origin, direction, t_min, t_max);
    case Shape::kEllipsoid:
      return intersectEllipsoid(part, origin, direction, t_min, t_max);
  }
  return std::nullopt;
}

std::vector<Vec3> hullPoints(const Primitive& part, const Cut* cuts) {
  if (part.shape == Shape::kBlock) return blockCorners(part, cuts);
  std::vector<Vec3> points;
  const Vec3 center = (part.lo + part.hi) * 0.5F, radii = (part.hi - part.lo) * 0.5F;
  const int k = part.axis, i = (k + 1) % 3, j = (k + 2) % 3;
  if (part.shape == Shape::kCylinder) {
    for (int n = 0; n < kCirclePoints; ++n)
      for (const float side : {-1.0F, 1.0F}) {
        Vec3 p = center;
        p[i] += circlePoint(n)[0] * radii[i];
        p[j] += circlePoint(n)[1] * radii[j];
        p[k] += side * radii[k];
        points.push_back(p);
      }
    return points;
  }
  for (int ring = 0; ring <= kCirclePoints / 2; ++ring)
    for (int n = 0; n < kCirclePoints; ++n) {
      const float latitude = std::numbers::pi_v<float> * 2 * static_cast<float>(ring) / kCirclePoints;
      points.push_back(center + radii * Vec3{circlePoint(n)[0] * std::sin(latitude),
                                             circlePoint(n)[1] * std::sin(latitude),
                                             std::cos(latitude) * circlePoint(0)[0]});
    }
  return points;
}

}  // namespace motorcade::synth
