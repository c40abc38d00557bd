#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "frontend/geometry/point_grid.hpp"
#include "frontend/matching/corner_lookup.hpp"

namespace motorcade {

/// A point that was found again in the next image.
struct MovedPoint {
  Eigen::Vector2f from_px;
  Shift shift;
};

/// Looks up how the neighbors of a point moved, to guess how it moved itself.
class NeighborShifts {
 public:
  /// The points lie in an image of this size.
  NeighborShifts(std::vector<MovedPoint> moved, int width, int height);

  /// Median of the shifts of the three points nearest to a position; empty when there are fewer. Of points at equal
  /// distances the first one is nearer.
  std::optional<Shift> medianAround(const Eigen::Vector2f& from_px) const;

 private:
  /// A point as a number for comparison: the bits of its squared distance, then its index.
  struct Neighbor {
    std::int64_t key;
    float squared_px() const;
    int index() const;
  };
  struct Place {
    float u_px, v_px;
    int index;
  };
  std::array<Neighbor, 3> nearestThree(const Eigen::Vector2f& from_px, float reach_px) const;

  std::vector<MovedPoint> moved_;
  PointGrid grid_;
  std::vector<Place> places_;  // where the points moved from, as the grid has them
};

}  // namespace motorcade
