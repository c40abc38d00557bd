#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace motorcade {

/// The command line of `motorcade view`.
struct ViewOptions {
  std::filesystem::path run;
  std::filesystem::path against;   // another run of the same drive; empty for none
  std::filesystem::path sequence;  // empty for the run's own
  std::optional<double> fps_hz;    // where the sequence has no times
  std::string address;             // ADDR:PORT
};

/// Shows a run that is over until SIGINT or SIGTERM. Returns the exit code.
int runView(const ViewOptions& options);

}  // namespace motorcade
