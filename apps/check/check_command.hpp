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

/// Says what of a sequence's first pairs would make results worse, or worthless, and prints what was measured.
/// Gives the exit code: 3 where they would be worthless.
int runCheck(const CheckOptions& options);

}  // namespace motorcade
