#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "frontend/image/float_lanes.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Compares the brightness of cells with the frame before, at the places from which motion and rest of the body take
/// them.
class MotionEvidence {
 public:
  static constexpr int kPixels = 9;  // around a cell that are compared

  /// Compares with the frame of `before`. All four outlive the evidence. The best place up to `slack` cells around the
  /// predicted one is compared, of motion as of rest.
  MotionEvidence(const LevelDisparities& disparities, const ObjectView& view, const ObjectView::Before& before,
                 const StereoCamera& camera, int slack = 0);

  /// Advantage of rest over motion with the body for each cell [gray levels, added over kPixels]; zero where the two
  /// can hardly be told apart. The cells are places in the map, and their disparities are known.
  std::vector<std::int16_t> operator()(std::span<const int> cells) const;

 private:
  /// Motion from rays at a depth to the image of the frame before [px of the level].
  struct Motion {
    Eigen::Matrix3f R;
    Eigen::Vector3f t;
  };
  using Lanes = std::array<float, kFloatLanes>;
  struct Places {
    Floats u, v, depth_m;
  };
  Places before(const Motion& motion, const std::array<Floats, 3>& p_cam) const;
  void compare(std::span<const int> cells, std::int16_t* evidence) const;
  int difference(int cell, const Places& moved, const Places& rested, int lane) const;

  const DisparityMap& map_;
  const Image &now_, &before_;
  int slack_;
  float scale_, offset_px_, fb_;
  Eigen::Vector2f focal_, middle_;  // of the level
  Motion moved_, rested_;
};

/// Drops cells around which the brightness rests rather than moves with the body. `view.before` is known.
void dropResting(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                 const StereoCamera& camera);

}  // namespace motorcade
