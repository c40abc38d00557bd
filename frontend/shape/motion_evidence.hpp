#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Compares the brightness of cells with the frame before, at the places from which motion and rest of the body take
/// them.
class MotionEvidence {
 public:
  static constexpr int kPixels = 9;  // around a cell that are compared

  /// Distances by which places may be off from where they are predicted.
  struct Slack {
    int cells = 0;           // around the place, of motion as of rest
    float disparity_px = 0;  // by which the cell's own may be wrong: moves the place of rest along its epipolar line
  };

  /// Compares with the frame of `before`. All four outlive the evidence. The best place within the slack is compared.
  MotionEvidence(const LevelDisparities& disparities, const ObjectView& view, const ObjectView::Before& before,
                 const StereoCamera& camera, const Slack& slack = {0, 0});

  /// Advantage of rest over motion with the body for each cell [gray levels, added over kPixels]; zero where the two
  /// can hardly be told apart. The cells are places in the map, and their disparities are known.
  std::vector<std::int16_t> operator()(std::span<const int> cells) const;

  /// Motion from rays at a depth to the image of the frame before [px of the level].
  struct Motion {
    Eigen::Matrix3f R;
    Eigen::Vector3f t;
  };
  struct Geometry {
    const DisparityMap& map;
    const Image &now, &before;
    Slack slack;
    float scale, offset_px, fb;
    Eigen::Vector2f focal, middle;  // of the level
    Motion moved, rested;
  };

 private:
  Geometry geometry_;
};

/// Drops cells around which the brightness rests rather than moves with the body. `view.before` is known.
void dropResting(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                 const StereoCamera& camera);

}  // namespace motorcade
