#pragma once

#include <array>
#include <optional>
#include <vector>

#include "apps/synth/scenes/frame_scene.hpp"
#include "apps/synth/shapes/item_grid.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade::synth {

enum class StereoSide { kLeft, kRight };

/// The first point that a ray meets.
struct RayHit {
  float t = 0;
  const Placed* placed = nullptr;
  const Primitive* part = nullptr;
  std::uint32_t surface = 0;  // one number per flat or round piece of surface
  Vec3 normal_body, position_body;
};

struct RayRange {
  float from = 0, to = 0;
};
/// Point where a ray meets the item; the ray is in the axes of the item's thing.
std::optional<RayHit> hitPart(const FrameScene& frame, std::uint32_t item, const Vec3& origin_body,
                              const Vec3& direction_body, const RayRange& range);

/// The rays of one camera of the stereo pair into a frame.
class CameraRays {
 public:
  /// Takes rays of a camera without errors, up to `beyond_px` outside of its image.
  CameraRays(const FrameScene& frame, const StereoCamera& camera, StereoSide side, float beyond_px = 0);

  const Vec3& origin() const { return origin_; }
  /// A direction of unit depth along the optical axis, so that a ray's parameter is the depth.
  Vec3 direction(float u_px, float v_px) const {
    return ahead_ + right_ * ((u_px - cx_px_) * pixel_x_) + down_ * ((v_px - cy_px_) * pixel_y_);
  }
  std::optional<RayHit> firstHit(float u_px, float v_px, const Vec3& direction, float t_max) const;

 private:
  Covered coveredBy(std::uint32_t item) const;
  Covered coveredByBox(const Primitive& part, const Placed& placed) const;
  std::optional<Covered> coveredByEllipsoid(const Primitive& part, const Placed& placed) const;

  const FrameScene& frame_;
  Vec3 origin_, right_, down_, ahead_;
  float cx_px_, cy_px_, pixel_x_, pixel_y_;
  std::vector<Vec3> origins_body_;  // the camera in the axes of each placed thing
  std::optional<ItemGrid> grid_;
};

/// Rays of one direction, from anywhere.
class ParallelRays {
 public:
  ParallelRays(const FrameScene& frame, const Vec3& direction);
  /// True if something is in the way before t_max.
  bool occluded(const Vec3& origin, float t_max) const;

 private:
  Covered coveredBy(std::uint32_t item) const;

  const FrameScene& frame_;
  Vec3 direction_, right_, down_;
  std::vector<Vec3> directions_body_;
  std::optional<ItemGrid> grid_;
};

/// Errors of a rig's calibration, each in its standard deviations, in the order of the columns of ObservationShifts.
using CalibrationErrors = std::array<double, kCalibrationErrors>;

/// The rays of a camera with errors: each of its pixels takes that of another pixel of a camera without errors.
class LensErrors {
 public:
  struct Pixel {
    float u_px, v_px;
  };
  LensErrors(const StereoCamera& camera, StereoSide side, const CalibrationErrors& errors);

  Pixel exact(float u_px, float v_px) const;
  /// Largest distance of such a pixel outside of the image.
  float beyond_px() const;

 private:
  StereoCamera camera_;
  StereoSide side_;
  Eigen::Matrix<double, kCalibrationErrors, 1> errors_;
};

}  // namespace motorcade::synth
