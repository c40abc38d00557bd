#include "apps/synth/synth_command.hpp"

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include <unistd.h>

#include "apps/synth/scene_builder.hpp"
#include "apps/synth/sequence_writer.hpp"

namespace motorcade {
namespace {

struct Arguments {
  std::string out, scene, size;
  int frames = 0, threads = 0;
  std::uint32_t seed = 1;
  bool without_movers = false;
};

/// `1242x375`, checked.
StereoCamera cameraOfSize(const std::string& size) {
  int width = 0, height = 0;
  char rest = 0;
  if (size.empty()) return synth::kittiCamera();
  if (std::sscanf(size.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 64 || height < 32 || width > 8192 ||
      height > 8192)
    throw CLI::ValidationError("--size", "expected WIDTHxHEIGHT from 64x32 to 8192x8192, got '" + size + "'");
  return synth::kittiCamera(width, height);
}

/// A bar on a terminal, a line every ten seconds elsewhere.
void reportProgress(int done, int frames, std::chrono::steady_clock::time_point& last) {
  const auto now = std::chrono::steady_clock::now();
  const bool terminal = isatty(STDERR_FILENO) == 1;
  if (!terminal && done < frames && now - last < std::chrono::seconds(10)) return;
  last = now;
  std::fprintf(stderr, terminal ? "\rframe %d of %d%s" : "frame %d of %d%s", done, frames,
               !terminal || done == frames ? "\n" : "");
}

int synthesize(const Arguments& arguments, const StereoCamera& camera) {
  const synth::Scene scene = synth::makeScene(arguments.scene, arguments.seed);
  synth::WriteOptions options;
  options.frames = arguments.frames;
  options.with_movers = !arguments.without_movers;
  options.camera = camera;
  options.render.threads =
      arguments.threads > 0 ? arguments.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const auto start = std::chrono::steady_clock::now();
  int frames = 0;
  options.progress = [&, last = start](int done, int of) mutable {
    frames = done;
    reportProgress(done, of, last);
  };
  synth::writeSequence(scene, arguments.out, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("%s: %d stereo pairs of scene '%s' in %.1f s (%.2f per second)\n", arguments.out.c_str(), frames,
              scene.name.c_str(), seconds, frames / seconds);
  return 0;
}

}  // namespace

void addSynthCommand(CLI::App& app, std::function<int()>& action) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("synth", "Render a stereo sequence with exact ground truth");
  command->add_option("OUT", arguments->out, "folder to write")->required();
  command->add_option("--scene", arguments->scene, "which scene")
      ->required()
      ->check(CLI::IsMember(synth::sceneNames()));
  command->add_option("--frames", arguments->frames, "number of frames; the scene's own length when absent")
      ->check(CLI::PositiveNumber);
  command->add_option("--seed", arguments->seed, "changes textures, colors, placement and, slightly, speeds")
      ->capture_default_str();
  command->add_option("--size", arguments->size, "image size as WIDTHxHEIGHT; 1242x375 when absent");
  command->add_option("--threads", arguments->threads, "rendering threads; all processors when absent")
      ->check(CLI::PositiveNumber);
  command->add_flag("--without-movers", arguments->without_movers, "the same scene without its moving vehicles");
  command->callback([arguments, &action] {
    const StereoCamera camera = cameraOfSize(arguments->size);
    action = [arguments, camera] { return synthesize(*arguments, camera); };
  });
}

}  // namespace motorcade
