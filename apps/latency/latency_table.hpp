#pragma once

#include <string>

#include "apps/latency/latency_report.hpp"

namespace motorcade {

/// A table of at most 100 columns.
std::string latencyTable(const LatencyReport& report);
std::string latencyJson(const LatencyReport& report);

}  // namespace motorcade
