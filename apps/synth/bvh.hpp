#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "apps/synth/vec3.hpp"

namespace motorcade::synth {

struct Bounds {
  Vec3 lo{1e30F, 1e30F, 1e30F}, hi{-1e30F, -1e30F, -1e30F};
  void include(const Bounds& other) {
    lo = min(lo, other.lo);
    hi = max(hi, other.hi);
  }
  float area() const {
    const Vec3 e = hi - lo;
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }
};

/// A bounding volume hierarchy over boxes, built anew for each frame (surface area heuristic over bins).
class Bvh {
 public:
  explicit Bvh(const std::vector<Bounds>& boxes);

  /// Calls `visit(item, t_max)` for items whose box the ray meets before t_max, near boxes first. `visit` returns the new t_max;
  /// a negative one ends the search.
  template <class Visit>
  void traverse(const Vec3& origin, const Vec3& direction, float t_max, const Visit& visit) const {
    if (nodes_.empty()) return;
    const Vec3 inverse{1 / nonZero(direction.x), 1 / nonZero(direction.y), 1 / nonZero(direction.z)};
    std::pair<float, std::uint32_t> stack[64];
    int size = 0;
    stack[size++] = {0.0F, 0};
    while (size > 0) {
      const auto [entry, index] = stack[--size];
      if (entry >= t_max) continue;
      const Node& node = nodes_[index];
      if (node.count > 0) {
        for (std::uint32_t i = 0; i < node.count; ++i) {
          t_max = visit(items_[node.first + i], t_max);
          if (t_max < 0) return;
        }
        continue;
      }
      const float a = enter(nodes_[node.first], origin, inverse, t_max), b = enter(nodes_[node.first + 1], origin, inverse, t_max);
      const bool a_first = a < b;
      if (std::max(a, b) < t_max) stack[size++] = {std::max(a, b), node.first + (a_first ? 1U : 0U)};
      if (std::min(a, b) < t_max) stack[size++] = {std::min(a, b), node.first + (a_first ? 0U : 1U)};
    }
  }

 private:
  struct Node {
    Vec3 lo;
    std::uint32_t first = 0;  // item, or the left child with the right one behind it
    Vec3 hi;
    std::uint32_t count = 0;  // 0 for an inner node
  };

  static float nonZero(float x) { return std::abs(x) < 1e-20F ? 1e-20F : x; }
  static float enter(const Node& node, const Vec3& o, const Vec3& inverse, float t_max) {
    const Vec3 a = (node.lo - o) * inverse, b = (node.hi - o) * inverse;
    const Vec3 near = min(a, b), far = max(a, b);
    const float in = std::max(std::max(near.x, near.y), std::max(near.z, 0.0F));
    const float out = std::min(std::min(far.x, far.y), std::min(far.z, t_max));
    return in <= out * 1.000001F ? in : 1e30F;
  }
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& boxes);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

}  // namespace motorcade::synth
