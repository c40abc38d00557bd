#pragma once

#include <string>

#include "apps/bridge/messages/ros_diagnostics.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// The tracker's state in a frame: OK where the camera's motion was measured, WARN where it was less surely, ERROR
/// where the pose is predicted, or something is wrong with the rig.
ros::DiagnosticArray diagnosticsOf(const Result& result, const std::string& hardware_id);

}  // namespace motorcade
