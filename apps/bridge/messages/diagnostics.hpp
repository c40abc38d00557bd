#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bridge/messages/ros_messages.hpp"
#include "motorcade/motorcade.hpp"

/// The values of diagnostic_msgs, and the tracker's state in them.
namespace motorcade::ros {

struct DiagnosticStatus {
  enum class Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2 };
  struct KeyValue {
    std::string key{}, value{};
  };
  Level level = Level::kOk;
  std::string name{}, message{}, hardware_id{};
  std::vector<KeyValue> values{};
};

struct DiagnosticArray {
  Header header{};
  std::vector<DiagnosticStatus> status{};
};

}  // namespace motorcade::ros

namespace motorcade {

/// The tracker's state in a frame. OK: the camera's motion was measured. WARN: it was measured less surely. ERROR: the
/// pose is predicted, or the rig has a fault.
ros::DiagnosticArray diagnosticsOf(const Result& result, const std::string& hardware_id);

}  // namespace motorcade
