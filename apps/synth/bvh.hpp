#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <immintrin.h>

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

/// A bounding volume hierarchy over boxes, built anew for each frame (surface area heuristic over bins). Four children to a
/// node, tested at once.
class Bvh {
 public:
  explicit Bvh(const std::vector<Bounds>& boxes);

  /// Calls `visit(item, t_max)` for items whose box the ray meets before t_max, near boxes first. `visit` returns the new t_max;
  /// a negative one ends the search.
  template <class Visit>
  void traverse(const Vec3& origin, const Vec3& direction, float t_max, const Visit& visit) const {
    if (nodes_.empty()) return;
    const Slabs slabs(origin, direction);
    std::array<Entry, kStack> stack;
    int size = 0;
    stack[0] = {0, 0};
    ++size;
    while (size > 0) {
      const Entry entry = stack[static_cast<std::size_t>(--size)];
      if (entry.t >= t_max) continue;
      if ((entry.child & kLeaf) != 0) {
        t_max = visit(entry.child & ~kLeaf, t_max);
        if (t_max < 0) return;
        continue;
      }
      const Node& node = nodes_[entry.child];
      alignas(16) std::array<float, 4> enter;
      const int bottom = size;
      for (auto hits = static_cast<unsigned>(slabs.test(node, t_max, enter)); hits != 0; hits &= hits - 1) {
        const auto i = static_cast<std::size_t>(__builtin_ctz(hits));
        int at = size++;  // far ones below, near ones on top
        for (; at > bottom && stack[static_cast<std::size_t>(at - 1)].t < enter[i]; --at)
          stack[static_cast<std::size_t>(at)] = stack[static_cast<std::size_t>(at - 1)];
        stack[static_cast<std::size_t>(at)] = {enter[i], node.child[i]};
      }
    }
  }

 private:
  static constexpr std::uint32_t kLeaf = 0x80000000U;
  static constexpr std::size_t kStack = 128;
  struct Entry {
    float t;
    std::uint32_t child;
  };
  struct alignas(64) Node {
    std::array<std::array<float, 4>, 3> lo, hi;  // by axis, then by child; an absent child is a box inside out
    std::array<std::uint32_t, 4> child{};        // a node, or kLeaf and an item
  };
  /// The ray against four boxes.
  struct Slabs {
    __m128 origin[3], inverse[3];
    bool forward[3];
    Slabs(const Vec3& o, const Vec3& d) {
      for (int k = 0; k < 3; ++k) {
        origin[k] = _mm_set1_ps(o[k]);
        inverse[k] = _mm_set1_ps(1 / (std::abs(d[k]) < 1e-20F ? 1e-20F : d[k]));
        forward[k] = d[k] >= 0 || std::abs(d[k]) < 1e-20F;
      }
    }
    int test(const Node& node, float t_max, std::array<float, 4>& enter) const {
      __m128 in = _mm_setzero_ps(), out = _mm_set1_ps(t_max);
      for (std::size_t k = 0; k < 3; ++k) {
        const __m128 lo = _mm_load_ps(node.lo[k].data()), hi = _mm_load_ps(node.hi[k].data());
        in = _mm_max_ps(in, _mm_mul_ps(_mm_sub_ps(forward[k] ? lo : hi, origin[k]), inverse[k]));
        out = _mm_min_ps(out, _mm_mul_ps(_mm_sub_ps(forward[k] ? hi : lo, origin[k]), inverse[k]));
      }
      _mm_store_ps(enter.data(), in);
      return _mm_movemask_ps(_mm_cmple_ps(in, _mm_mul_ps(out, _mm_set1_ps(1.000001F))));
    }
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& boxes);
  std::uint32_t split(std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& boxes);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

}  // namespace motorcade::synth
