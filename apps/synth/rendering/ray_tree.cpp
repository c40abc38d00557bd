#include "apps/synth/rendering/ray_tree.hpp"

#include <array>
#include <numeric>

namespace motorcade::synth {
namespace {

constexpr std::uint32_t kLeafItems = 4;
constexpr std::size_t kMaxDepth = 64;  // halves of halves: far more than any number of items needs

/// Ray parameter at which a ray enters a box; beyond `limit` if it does not.
float entry(const Vec3& lo, const Vec3& hi, const Vec3& origin, const Vec3& inverse, float limit) {
  float enter = 0, leave = limit;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = (lo[axis] - origin[axis]) * inverse[axis], b = (hi[axis] - origin[axis]) * inverse[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : 1e30F;
}

Vec3 inverseOf(const Vec3& direction) {
  Vec3 inverse;
  for (int axis = 0; axis < 3; ++axis)
    inverse[axis] = 1 / (std::abs(direction[axis]) < 1e-9F ? 1e-9F : direction[axis]);
  return inverse;
}

}  // namespace

RayTree::RayTree(const FrameScene& frame) : frame_(frame), items_(frame.items().size()) {
  std::iota(items_.begin(), items_.end(), 0U);
  std::vector<Bounds> bounds;
  for (const std::uint32_t item : items_) bounds.push_back(boundsOf(item));
  if (!items_.empty()) build(0, static_cast<std::uint32_t>(items_.size()), bounds);
}

RayTree::Bounds RayTree::boundsOf(std::uint32_t item) const {
  constexpr float kMargin_m = 1e-3F;  // for rounding
  const Placed& placed = frame_.placedOf(item);
  const Primitive& part = frame_.partOf(item);
  const Vec3 center = placed.rotation * ((part.lo + part.hi) * 0.5F) + placed.translation;
  const Vec3 half = (part.hi - part.lo) * 0.5F;
  const auto reach = [&](const Vec3& row) {
    return std::abs(row.x) * half.x + std::abs(row.y) * half.y + std::abs(row.z) * half.z + kMargin_m;
  };
  const Vec3 r{reach(placed.rotation.row0), reach(placed.rotation.row1), reach(placed.rotation.row2)};
  return {center - r, center + r};
}

void RayTree::build(std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& bounds) {
  Node node{bounds[items_[first]].lo, bounds[items_[first]].hi, first, count, 0};
  for (std::uint32_t i = first; i < first + count; ++i) {
    node.lo = min(node.lo, bounds[items_[i]].lo);
    node.hi = max(node.hi, bounds[items_[i]].hi);
  }
  const std::size_t index = nodes_.size();
  nodes_.push_back(node);
  if (count <= kLeafItems) return;
  const Vec3 size = node.hi - node.lo;
  const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  const auto begin = items_.begin() + first;
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    const float at = bounds[a].lo[axis] + bounds[a].hi[axis], other = bounds[b].lo[axis] + bounds[b].hi[axis];
    return at != other ? at < other : a < b;
  });
  build(first, half, bounds);
  nodes_[index].count = 0;
  nodes_[index].right = static_cast<std::uint32_t>(nodes_.size());
  build(first + half, count - half, bounds);
}

std::optional<RayHit> RayTree::firstHit(const Vec3& origin, const Vec3& direction, float t_max) const {
  constexpr float kOff_m = 1e-3F;  // not the surface that the ray starts on
  std::optional<RayHit> best;
  const Vec3 inverse = inverseOf(direction);
  std::array<std::uint32_t, kMaxDepth> stack{};
  std::size_t waiting = nodes_.empty() ? 0 : 1;
  while (waiting > 0) {
    const std::uint32_t index = stack[--waiting];
    const Node& node = nodes_[index];
    if (entry(node.lo, node.hi, origin, inverse, t_max) >= t_max) continue;
    if (node.count == 0) {
      stack[waiting++] = node.right;
      stack[waiting++] = index + 1;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Placed& placed = frame_.placedOf(items_[i]);
      const Vec3 o = placed.rotation.transposed(origin - placed.translation);
      const auto hit = hitPart(frame_, items_[i], o, placed.rotation.transposed(direction), {kOff_m, t_max});
      if (!hit) continue;
      best = hit;
      t_max = hit->t;
    }
  }
  return best;
}

}  // namespace motorcade::synth
