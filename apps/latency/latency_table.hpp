#pragma once

#include <string>

#include "apps/latency/latency_report.hpp"

namespace motorcade {

/// At most 100 columns wide.
std::string latencyTable(const LatencyReport& report);
std::string latencyJson(const LatencyReport& report);

}  // namespace motorcade
