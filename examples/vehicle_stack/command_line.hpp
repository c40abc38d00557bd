#pragma once

#include <stdexcept>
#include <string>

#include <motorcade/motorcade.hpp>

#include "folder_camera.hpp"
#include "vehicle_frame.hpp"

namespace vehicle_stack {

struct CommandLine {
  std::string drive;
  FolderCamera::Params camera{};
  Mounting mounting{};
  double margin = 2;  // of standard deviations: on real drives the tracker's are too small
  motorcade::Tracker::Options tracker{};
};

/// The message names the option and what it takes.
class UsageError : public std::runtime_error {
 public:
  using runtime_error::runtime_error;
};

/// Throws UsageError.
CommandLine parsed(int argc, const char* const* argv);
extern const char* const kUsageText;

}  // namespace vehicle_stack
