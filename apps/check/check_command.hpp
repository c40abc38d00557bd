#pragma once

#include <filesystem>
#include <string>

#include "io/sequence/sequence.hpp"

namespace motorcade {

struct CheckOptions {
  std::filesystem::path sequence;
  GivenCameras given;
  double fps_hz = 10;  // where the sequence has no times
  std::string frames;  // A:B; the first twenty are looked at
  std::string inject;  // faults, to see whether they are found
  std::filesystem::path json;
  std::filesystem::path page;  // HTML, with pictures
};

/// Prints what in a sequence's first pairs would make results worse or worthless, and what was measured. Returns the
/// exit code: 3 where results would be worthless.
int runCheck(const CheckOptions& options);

}  // namespace motorcade
