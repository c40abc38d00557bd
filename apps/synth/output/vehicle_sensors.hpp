#pragma once

#include <vector>

#include "apps/synth/scenes/scene.hpp"
#include "core/vehicle_motion.hpp"

namespace motorcade::synth {

/// What speed and yaw rate sensors of the camera's car tell over so many frames, fifty times a second, with the faults
/// of cheap ones, drawn with the scene's seed: the scale is off by up to 2 %, the bias is up to 0.3 deg/s, stamps are
/// 20 ms late, and for a while the wheels spin.
std::vector<VehicleMotionSample> sensedMotion(const Scene& scene, int frames);

}  // namespace motorcade::synth
