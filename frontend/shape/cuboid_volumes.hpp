#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Tells where the points of cells are: in the volume that the cuboid may fill, and in the one that it usually fills.
/// Works in single precision, on eight cells of a row at a time. The disparities outlive it.
class CuboidVolumes {
 public:
  static constexpr std::uint8_t kOutside = 0, kPossible = 1, kUsual = 2;  // in which volume a cell's point lies
  static constexpr double kDisparitySigma_px = 0.25;  // of a dense disparity, in pixels of its level
  static constexpr double kCoarseSigma_px = 1;        // before it is refined

  /// Standard deviation before disparities of a level are refined: what no refinement may carry into a volume need not
  /// be refined. Disparities of the finest level are refined but once.
  static constexpr double coarseSigma_px(int level) { return level > 1 ? kCoarseSigma_px : 0.75 * kCoarseSigma_px; }

  CuboidVolumes(const LevelDisparities& disparities, const ObjectView& view, const StereoCamera& camera);

  /// Tells where the cells of the window that are not outside lie. Outside are those whose disparity is unknown, or
  /// would have to be wrong by more than twice `sigma_px` [px of the level].
  void tell(double sigma_px, std::span<std::uint8_t> cells) const;

  struct Cuboid {
    Eigen::Vector3f least, most;
  };
  struct Other {
    Eigen::Matrix3f R_body_cam;
    Eigen::Vector3f origin;  // of the camera, in the body frame
    Cuboid cuboid;
  };
  struct Geometry {
    float scale, offset_px, fb, least_px = 0, most_px = 0;
    Eigen::Vector2f first_ray, ray_step;  // of the first cell; from a column or row to the next
    Eigen::Vector3f ground_normal;
    float ground_height_m;
    Eigen::Matrix3f R_body_cam;
    Eigen::Vector3f origin;  // of the camera, in the body frame
    Cuboid possible{}, usual{};
    std::vector<Other> others{};
  };

 private:
  void boundDisparities(const ObjectView& view, const StereoCamera& camera);
  void addOthers(const ObjectView& view, const StereoCamera& camera);

  const LevelDisparities& disparities_;
  Geometry geometry_;
};

}  // namespace motorcade
