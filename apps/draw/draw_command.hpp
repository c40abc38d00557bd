#pragma once

#include <filesystem>
#include <optional>

#include "io/sequence/sequence.hpp"

namespace motorcade {

struct DrawOptions {
  std::filesystem::path run{}, sequence{};  // the sequence that the run names when empty
  std::filesystem::path out{}, video{};     // folder for pictures, file for a video: one of them or both
  std::optional<double> fps_hz{};           // of a sequence without times; the run's when empty
  FrameRange frames{};                      // of the sequence
  int every = 1;
};

/// Draws frames of a run as PNG pictures `frame_NNNNNN.png`, as a video at the pace of the capture, or both. Where no
/// ffmpeg is installed, the video's pictures go into a folder of its name instead. Returns the exit code, that of the
/// signal if one came. Failures are UserErrors.
int runDraw(const DrawOptions& options);

}  // namespace motorcade
