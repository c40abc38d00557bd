#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/synth/output/sequence_writer.hpp"

namespace motorcade {

struct SynthOptions {
  std::string out, scene, size;  // WIDTHxHEIGHT; empty for KITTI's
  int frames = 0, threads = 0;   // 0: the scene's own length, all processors
  std::uint32_t seed = 1;
  std::string style = "plain";
  bool without_movers = false, vehicle_motion = false;
  synth::RigError rig_error;
};

/// The scenes that there are.
std::vector<std::string> synthSceneNames();
/// The styles that there are.
std::vector<std::string> synthStyleNames();
/// A scene's own length. The name is one of those above.
int synthSceneFrames(const std::string& scene, std::uint32_t seed);

/// Renders a sequence; gives the exit code. Failures are UserErrors.
int runSynth(const SynthOptions& options);

}  // namespace motorcade
