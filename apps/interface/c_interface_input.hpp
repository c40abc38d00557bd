#pragma once

#include "motorcade/motorcade.h"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// The caller's structs in C++. Each throws `Error`, naming the member.
Camera cameraOf(const motorcade_camera* given);
Tracker::Options optionsOf(const motorcade_options* given);
Pair pairOf(const motorcade_pair* given);
VehicleMotion motionOf(const motorcade_vehicle_motion* given);

motorcade_options defaultOptions();
motorcade_pair defaultPair();

}  // namespace motorcade
