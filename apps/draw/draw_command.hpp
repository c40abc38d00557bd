#pragma once

#include <filesystem>

#include "io/sequence.hpp"

namespace motorcade {

struct DrawOptions {
  std::filesystem::path run{}, sequence{}, out{};
  double fps_hz = 10;
  FrameRange frames{};  // of the sequence
  int every = 1;
};

/// Draws frames of a run as PNG pictures `frame_NNNNNN.png`; gives the exit code. Failures are UserErrors.
int runDraw(const DrawOptions& options);

}  // namespace motorcade
