#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <immintrin.h>

#include "apps/synth/shapes/vec3.hpp"

namespace motorcade::synth {

/// Extent of an item for a family of rays that all cross one plane (from one point, or parallel): a rectangle of the
/// plane, and a range along the rays.
struct Covered {
  float left = 1e30F, top = 1e30F, right = -1e30F, bottom = -1e30F;
  float near = 1e30F, far = -1e30F;
  std::uint32_t item = 0;

  void include(float x, float y, float depth) {
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
    near = std::min(near, depth);
    far = std::max(far, depth);
  }
};

/// A grid of items by the area that they cover in the plane of a family of rays. Square cells have a list each, near
/// items first, of which four are tested at once. Items that cover no point of `area` are left out; a ray through a
/// point outside of it is slower.
class ItemGrid {
 public:
  struct Area {
    float left, top, right, bottom;
  };
  ItemGrid(std::vector<Covered> items, const Area& area, float cell);

  /// Calls `visit(item, limit)` for the items that cover the ray through (x, y) between `from` and `limit`, near ones
  /// first. `visit` returns the new limit; one below `from` ends the search.
  template <class Visit>
  void traverse(float x, float y, float from, float limit, const Visit& visit) const {
    const std::size_t cell = row(y) * columns_ + column(x);
    for (std::uint32_t g = first_[cell]; g < first_[cell + 1]; ++g) {
      const Group& group = groups_[g];
      if (group.near[0] >= limit) return;
      for (auto hits = static_cast<unsigned>(group.test(x, y, from)); hits != 0; hits &= hits - 1) {
        const int i = __builtin_ctz(hits);
        if (group.near[i] >= limit) return;
        limit = visit(group.item[i], limit);
      }
    }
  }

 private:
  struct alignas(16) Group {
    using Four = std::array<float, 4>;
    static constexpr Four kNever{1e30F, 1e30F, 1e30F, 1e30F};
    Four left = kNever, top = kNever, right = kNever, bottom = kNever, near = kNever, far = kNever;
    std::array<std::uint32_t, 4> item{};

    int test(float x, float y, float from) const {
      const __m128 xs = _mm_set1_ps(x), ys = _mm_set1_ps(y);
      const auto load = [](const Four& four) { return _mm_load_ps(four.data()); };
      const __m128 across = _mm_and_ps(_mm_cmple_ps(load(left), xs), _mm_cmpge_ps(load(right), xs));
      const __m128 down = _mm_and_ps(_mm_cmple_ps(load(top), ys), _mm_cmpge_ps(load(bottom), ys));
      return _mm_movemask_ps(_mm_and_ps(_mm_and_ps(across, down), _mm_cmpgt_ps(load(far), _mm_set1_ps(from))));
    }
  };
  int column(float x) const {
    return static_cast<int>(std::clamp((x - area_.left) * per_unit_, 0.0F, static_cast<float>(columns_ - 1)));
  }
  int row(float y) const {
    return static_cast<int>(std::clamp((y - area_.top) * per_unit_, 0.0F, static_cast<float>(rows_ - 1)));
  }
  template <class Visit>
  void forCells(const Covered& item, const Visit& visit) const;

  Area area_;
  float per_unit_;
  int columns_, rows_;
  std::vector<std::uint32_t> first_;  // of each cell's groups
  std::vector<Group> groups_;
};

}  // namespace motorcade::synth
