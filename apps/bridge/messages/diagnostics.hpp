#pragma once

#include <string>

#include "apps/bridge/messages/ros_diagnostics.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// The tracker's state in a frame. OK: the camera's motion was measured. WARN: it was measured less surely. ERROR: the
/// pose is predicted, or the rig has a fault.
ros::DiagnosticArray diagnosticsOf(const Result& result, const std::string& hardware_id);

}  // namespace motorcade
