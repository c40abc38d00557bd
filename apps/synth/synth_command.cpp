#include "apps/synth/synth_command.hpp"

#include <chrono>
#include <cstdio>
#include <thread>

#include <unistd.h>

#include "apps/console/log.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

/// `1242x375`, checked.
StereoCamera cameraOfSize(const std::string& size) {
  int width = 0, height = 0;
  char rest = 0;
  if (size.empty()) return synth::kittiCamera();
  if (std::sscanf(size.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 64 || height < 32 || width > 8192 ||
      height > 8192)
    throw UsageError("--size " + size + ": write WIDTHxHEIGHT from 64x32 to 8192x8192");
  return synth::kittiCamera(width, height);
}

/// A bar on a terminal, a line every ten seconds elsewhere.
void reportProgress(int done, int frames, std::chrono::steady_clock::time_point& last) {
  if (!tellsProgress()) return;
  const auto now = std::chrono::steady_clock::now();
  const bool terminal = isatty(STDERR_FILENO) == 1;
  if (!terminal && done < frames && now - last < std::chrono::seconds(10)) return;
  last = now;
  std::fprintf(stderr, terminal ? "\rframe %d of %d%s" : "frame %d of %d%s", done, frames,
               !terminal || done == frames ? "\n" : "");
}

}  // namespace

std::vector<std::string> synthSceneNames() { return synth::sceneNames(); }

std::vector<std::string> synthStyleNames() { return synth::styleNames(); }

int synthSceneFrames(const std::string& scene, std::uint32_t seed) { return synth::makeScene(scene, seed).frames; }

int runSynth(const SynthOptions& options) {
  const StereoCamera camera = cameraOfSize(options.size);
  const synth::Scene scene = synth::makeScene(options.scene, options.seed);
  synth::WriteOptions writing;
  writing.frames = options.frames;
  writing.with_movers = !options.without_movers;
  writing.camera = camera;
  writing.rig_error = options.rig_error;
  writing.vehicle_motion = options.vehicle_motion;
  writing.render.style = synth::styleOf(options.style);
  writing.render.threads =
      options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const auto start = std::chrono::steady_clock::now();
  int frames = 0;
  writing.progress = [&, last = start](int done, int of) mutable {
    frames = done;
    reportProgress(done, of, last);
  };
  synth::writeSequence(scene, options.out, writing);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (tellsProgress())
    std::printf("%s: %d stereo pairs of scene '%s' in %.1f s (%.2f per second)\n", options.out.c_str(), frames,
                scene.name.c_str(), seconds, frames / seconds);
  return 0;
}

}  // namespace motorcade
