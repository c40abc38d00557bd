#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/stereo_camera.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/messages.hpp"
#include "frontend/shape/box_belief.hpp"
#include "frontend/shape/dense_disparity.hpp"

namespace motorcade {

/// View of an object by the camera in one frame, as far as it is known before its outline.
struct ObjectView {
  /// Cells between a body that moved and what rests, in the image of an earlier frame, from which on the two can be
  /// told apart. Each estimate may be off by a cell.
  static constexpr double kWellApart = 6;
  /// Width of a small body in cells; 0 of other bodies. Someone evenly dressed looks the same until gone by it.
  double width = 0;
  SE3 T_cam_body;
  BoxEstimate box;
  bool small = false;  // looked for in the volume of a person or a two-wheeler
  int level = 1;       // of the pyramid, at which its surroundings are looked at
  GroundPlane ground;
  double disparity_offset_px = 0;
  std::span<const ScenePoint> scene{};  // the frame's points
  struct Other {
    SE3 T_body_cam;
    Eigen::Vector3d least, most;
    /// Motion of what goes along with it from the camera now to that of the earlier frame. Only objects that were known
    /// before this one have it.
    std::optional<SE3> T_before_cam{};
  };
  std::optional<Eigen::AlignedBox3d> points{};  // body frame: around the followed points, without outliers
  /// The left images of this frame and an earlier one, and where the body and what rests were then.
  struct Before {
    const ImagePyramid *now, *before;
    SE3 T_before_body, T_before_cam;
    FrameId frame{};
    double apart = 0;  // cells in the image of then, between the body and what rests where it is now
  };
  std::optional<Before> before{};       // the frame before, where the object was reported in it
  std::optional<Before> well_before{};  // a recent one in which the body and what rests are well apart, if there is one
  std::vector<Other> others{};          // cuboids of other objects, where the object cannot be
  std::vector<Other> lost{};            // those of objects that were lost, where they would be: it may be one of them
};

/// Disparities of a window at some level of the image pyramid.
struct LevelDisparities {
  int level = 0;
  DisparityMap map;
  /// Disparity of a cell [px of full size]; empty where the images agree on none.
  std::optional<double> disparity_px(int column, int row) const {
    const float d = map.at(column, row);
    if (d == DisparityMap::kNone) return std::nullopt;
    return static_cast<double>(d) * (1 << level);
  }
  /// Middle of a column or row [px of full size].
  double u_px(int column) const { return fromLevel(static_cast<float>(map.window.u0 + column), level); }
  double v_px(int row) const { return fromLevel(static_cast<float>(map.window.v0 + row), level); }
};

/// Cells of the window that show the object: those above the road that lie within its cuboid, as far as both are known.
/// Gaps are filled and pieces beside it dropped.
struct Outline {
  PixelWindow window;  // of the cells
  std::vector<std::uint8_t> inside;
  /// Bounds of the cells inside; empty window when there are none.
  PixelWindow bounds() const;
  int count() const;
  /// First and last cell inside of each row, or column; first beyond last where there is none.
  using Spans = std::vector<std::pair<int, int>>;
  Spans spansOfRows() const;
  Spans spansOfColumns() const;
  /// Some of the cells inside, evenly spread: their places in `inside`.
  std::vector<int> samples() const;
  bool at(int column, int row) const { return inside[static_cast<std::size_t>(row) * window.width + column] != 0; }
};

/// Cells of the window that may show the object, as far as coarse disparities tell: their places in the map.
std::vector<int> cellsInReach(const LevelDisparities& disparities, const ObjectView& view, const StereoCamera& camera);

/// Finds the outline among the cells in reach, with their disparities refined.
Outline findOutline(const LevelDisparities& disparities, std::span<const int> cells, const ObjectView& view,
                    const StereoCamera& camera);

/// True when the brightness of an outline says that it moved with the body since the frame before, rather than rested;
/// false where the two can hardly be told apart.
bool movesWithBody(const Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                   const StereoCamera& camera);

/// Box in the left image around the cuboid, cut at the image's border; empty when it does not lie in the image.
std::optional<Box> projectedBox(const Eigen::Vector3d& least, const Eigen::Vector3d& most, const SE3& T_cam_body,
                                const StereoCamera& camera);

/// The corners of a cuboid, numbered 0 ... 7 by bits: the greater x, y, z.
Eigen::Vector3d cornerOf(const Eigen::Vector3d& least, const Eigen::Vector3d& most, int corner);

}  // namespace motorcade
