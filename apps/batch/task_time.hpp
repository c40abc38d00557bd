#pragma once

#include <chrono>
#include <string>

namespace motorcade {

/// A time limit in one of Slurm's forms: minutes, minutes:seconds, hours:minutes:seconds, days-hours,
/// days-hours:minutes, days-hours:minutes:seconds; 0 for an empty text. Throws UsageError.
std::chrono::seconds taskTime(const std::string& text);

}  // namespace motorcade
