#pragma once

#include <filesystem>

namespace motorcade {

struct LatencyOptions {
  std::filesystem::path run{}, json{};
};

/// Prints the times of a run's frames by their causes; returns the exit code. Failures are UserErrors.
int runLatency(const LatencyOptions& options);

}  // namespace motorcade
