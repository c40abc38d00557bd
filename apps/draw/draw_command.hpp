#pragma once

#include <filesystem>
#include <functional>

#include "io/sequence.hpp"

namespace CLI {
class App;
}

namespace motorcade {

struct DrawOptions {
  std::filesystem::path run{}, sequence{}, out{};
  double fps_hz = 10;
  FrameRange frames{};  // of the sequence
  int every = 1;
};

/// Draws frames of a run as PNG pictures `frame_NNNNNN.png`; gives the exit code. Failures are UserErrors.
int runDraw(const DrawOptions& options);

/// Registers `motorcade draw`; parsing it sets `action`.
void addDrawCommand(CLI::App& app, std::function<int()>& action);

}  // namespace motorcade
