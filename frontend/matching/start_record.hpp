#pragma once

#include <cstddef>
#include <vector>

namespace motorcade {

/// Remembers for each cell of the image how many points that started there were found again in the next frame, so that
/// none start where they hardly ever are: on grain of the road, in reflections, at a border where the scene leaves the
/// image. It forgets within some frames, so that such a cell is tried again, as when a vehicle has come.
class StartRecord {
 public:
  /// To be called once a frame, before `add`. Images of another size begin a new record.
  void beginFrame(int width, int height);
  /// What became of a point that started in the frame before.
  void add(float u_px, float v_px, bool followed);
  /// Is a point that starts here likely enough to be followed?
  bool isWorthTrying(float u_px, float v_px) const;

 private:
  struct Cell {
    float started = 0, followed = 0;  // those of earlier frames count less
  };
  std::size_t cellAt(float u_px, float v_px) const;

  int width_ = 0, height_ = 0;
  std::vector<Cell> cells_;  // empty before the first frame
};

}  // namespace motorcade
