#pragma once

#include <filesystem>

namespace motorcade {

struct LatencyOptions {
  std::filesystem::path run{}, json{};
};

/// Prints where the time of a run's frames went; gives the exit code. Failures are UserErrors.
int runLatency(const LatencyOptions& options);

}  // namespace motorcade
