#pragma once

#include <filesystem>
#include <optional>

#include "io/sequence.hpp"

namespace motorcade {

struct DrawOptions {
  std::filesystem::path run{}, sequence{}, out{};  // the sequence that the run names when empty
  std::optional<double> fps_hz{};                  // of a sequence without times; the run's when empty
  FrameRange frames{};                             // of the sequence
  int every = 1;
};

/// Draws frames of a run as PNG pictures `frame_NNNNNN.png`; gives the exit code. Failures are UserErrors.
int runDraw(const DrawOptions& options);

}  // namespace motorcade
