#pragma once

#include <string>
#include <vector>

#include "apps/synth/rendering/renderer.hpp"
#include "apps/synth/scenes/frame_scene.hpp"
#include "apps/synth/scenes/scene.hpp"
#include "core/vehicle_motion.hpp"

namespace motorcade::synth {

/// An object as the left camera sees it, in the terms of KITTI's tracking labels.
struct Label {
  int id = -1;
  std::string type;
  double truncated = 0;  // share of the object's box outside the image
  int occluded = 0;      // 0: at least 80 % of what is in the image is visible, 1: at least 40 %, 2: less
  double left_px = 0, top_px = 0, right_px = 0, bottom_px = 0;  // of the whole object, clipped to the image
  double height_m = 0, width_m = 0, length_m = 0;
  Eigen::Vector3d location_cam;  // center of the box's bottom face
  double rotation_y_rad = 0, alpha_rad = 0;
};

/// Labels of the objects that show at least `min_pixels` in the left image.
std::vector<Label> labelsOf(const FrameScene& frame, const StereoCamera& camera, const Rendering& left,
                            int min_pixels = 12);

/// `frame id type truncated occluded alpha left top right bottom h w l x y z rotation_y`.
std::string labelLine(int frame, const Label& label);

/// Samples of the speed and yaw rate sensors of the camera's car over `frames` frames, fifty per second. They have the
/// faults of cheap sensors, drawn with the scene's seed. The scale is off by up to 2 %, the bias is up to 0.3 deg/s,
/// stamps are 20 ms late, and for a while the wheels spin.
std::vector<VehicleMotionSample> sensedMotion(const Scene& scene, int frames);

}  // namespace motorcade::synth
