#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace motorcade {

/// The command line of `motorcade export`.
struct ExportOptions {
  std::filesystem::path run{}, sequence{};
  std::optional<double> fps_hz{};
  std::filesystem::path mcap{};  // file
  std::filesystem::path osi{};   // file
  std::string mounting{};        // X,Y,Z,ROLL,PITCH,YAW of `osi`; empty: the camera stands for the vehicle
  std::filesystem::path tum{};   // folder
  bool with_predicted = false;
};

/// Writes a run, also one that was killed, for other programs; gives the exit code. Failures are UserErrors.
int runExport(const ExportOptions& options);

}  // namespace motorcade
