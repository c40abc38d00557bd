#pragma once

#include <vector>

#include "apps/synth/scenes/scene.hpp"
#include "core/vehicle_motion.hpp"

namespace motorcade::synth {

/// Samples of the speed and yaw rate sensors of the camera's car over `frames` frames, fifty per second. They have the
/// faults of cheap sensors, drawn with the scene's seed. The scale is off by up to 2 %, the bias is up to 0.3 deg/s,
/// stamps are 20 ms late, and for a while the wheels spin.
std::vector<VehicleMotionSample> sensedMotion(const Scene& scene, int frames);

}  // namespace motorcade::synth
