#pragma once

#include <vector>

namespace motorcade {

/// Remembers points of an image, so that others keep their distance. Each cell of a grid as wide as the distance
/// remembers the last point in it.
class Occupancy {
 public:
  Occupancy(int width, int height, double distance_px)
      : distance_px_(static_cast<float>(distance_px)),
        columns_(cell(static_cast<float>(width)) + 3),
        rows_(cell(static_cast<float>(height)) + 3),
        cells_(columns_ * rows_, {kFarAway_px, kFarAway_px}) {}

  /// True when a remembered point lies nearer than the distance.
  bool near(float u_px, float v_px) const {
    const int x = cell(u_px) + 1, y = cell(v_px) + 1;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Position& p = cells_[(y + dy) * columns_ + x + dx];
        const float du = p.u_px - u_px, dv = p.v_px - v_px;
        if (du * du + dv * dv < distance_px_ * distance_px_) return true;
      }
    }
    return false;
  }
  /// Remembers a point, which lies inside the image.
  void take(float u_px, float v_px) { cells_[(cell(v_px) + 1) * columns_ + cell(u_px) + 1] = {u_px, v_px}; }

 private:
  struct Position {
    float u_px, v_px;
  };
  static constexpr float kFarAway_px = -1e9F;

  int cell(float x_px) const { return static_cast<int>(x_px / distance_px_); }

  float distance_px_;
  int columns_, rows_;  // with a margin of one empty cell
  std::vector<Position> cells_;
};

}  // namespace motorcade
