#pragma once

#include <cstdint>
#include <vector>

#include "apps/synth/rendering/rays.hpp"
#include "apps/synth/scenes/frame_scene.hpp"
#include "apps/synth/scenes/style.hpp"
#include "core/image.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade::synth {

/// An image of one camera of the stereo pair, and the exact depth and object at the center of each pixel.
struct Rendering {
  Image image;
  std::vector<float> depth_m;        // 0 for the sky
  std::vector<std::int16_t> object;  // id, or -1
};

struct RenderOptions {
  int threads = 2;
  float noise_levels = 1.3F;  // standard deviation of the sensor's noise at middle gray; 0 for none
  bool equal_gains = false;   // both cameras equally sensitive
  Style style = Style::kPlain;
  CalibrationErrors errors{};  // of the rig
};

/// Renders the image of one camera. The result does not depend on the number of threads.
Rendering render(const FrameScene& frame, const StereoCamera& camera, StereoSide side, const RenderOptions& options);

/// KITTI's gray pair, scaled to another size when asked for.
StereoCamera kittiCamera(int width_px = 1242, int height_px = 375);

}  // namespace motorcade::synth
