#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bridge/messages/ros_messages.hpp"

/// The values of diagnostic_msgs.
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
