#pragma once

#include <string>

#include "core/se3.hpp"

namespace motorcade {

/// T_vehicle_cam of `--mounting X,Y,Z,ROLL,PITCH,YAW`, in meters and degrees. Vehicle and camera both have x ahead, y
/// left and z up. The camera is turned by roll, then pitch, then yaw about the vehicle's axes. Throws UsageError.
SE3 parseMounting(const std::string& text);

}  // namespace motorcade
