#pragma once

#include <memory>
#include <vector>

#include "apps/synth/scenes/path.hpp"

namespace motorcade::synth {

/// A strip of asphalt along a path, with its painted lines.
struct Road {
  struct Line {
    double left_m = 0, width_m = 0.12;
    bool dashed = true;
  };
  std::shared_ptr<const Path> path;
  double half_width_m = 5.6;
  std::vector<Line> lines;
  std::vector<double> crosswalks_m{};  // arc lengths where people cross, between bars of paint
};

/// Position of a ground point on the roads.
struct RoadPosition {
  int road = -1;                   // the road it is deepest inside of or nearest to; -1 far from all
  float along_m = 0;               // arc length on that road
  float left_m = 0;                // offset from its center line
  float outside_m = 1e3F;          // signed distance from the curb: negative on the asphalt
  float next_outside_m = 1e3F;     // the same for the second nearest road
  float along_x = 1, along_y = 0;  // direction of the road
};

/// Finds the road under a point, through a grid over the plane.
class RoadNetwork {
 public:
  RoadNetwork() = default;
  explicit RoadNetwork(std::vector<Road> roads);

  const std::vector<Road>& roads() const { return roads_; }
  RoadPosition locate(double x_m, double y_m) const;

 private:
  struct Candidate {
    int road, sample;
  };
  static constexpr double kCell_m = 4, kReach_m = 36;  // reach: how far from a road's center line positions are known

  std::vector<Road> roads_;
  std::vector<std::vector<Eigen::Vector2d>> along_;  // direction at each sample of each road's path
  double origin_x_m_ = 0, origin_y_m_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<Candidate>> cells_;
};

}  // namespace motorcade::synth
