#pragma once

#include <vector>

#include "apps/synth/rendering/rays.hpp"

namespace motorcade::synth {

/// All parts of a frame in a tree of boxes, for rays from anywhere to anywhere.
class RayTree {
 public:
  explicit RayTree(const FrameScene& frame);
  /// The first item that the ray meets before t_max.
  std::optional<RayHit> firstHit(const Vec3& origin, const Vec3& direction, float t_max) const;

 private:
  struct Node {
    Vec3 lo, hi;
    std::uint32_t first = 0, count = 0;  // items of a leaf; count is 0 for a fork
    std::uint32_t right = 0;             // a fork's second child; the first one follows the fork
  };
  struct Bounds {
    Vec3 lo, hi;
  };
  Bounds boundsOf(std::uint32_t item) const;
  void build(std::uint32_t first, std::uint32_t count, const std::vector<Bounds>& bounds);

  const FrameScene& frame_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

}  // namespace motorcade::synth
