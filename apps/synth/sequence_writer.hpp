#pragma once

#include <filesystem>
#include <functional>

#include "apps/synth/renderer.hpp"
#include "apps/synth/scene.hpp"

namespace motorcade::synth {

struct WriteOptions {
  int frames = 0;  // 0: as many as the scene has
  bool with_movers = true;
  StereoCamera camera = kittiCamera();
  RenderOptions render;
  std::function<void(int done, int frames)> progress;  // called after each frame
};

/// Renders a scene into a folder in the plain KITTI layout, ground truth included.
/// Throws OutputError, naming the file, when something cannot be written.
void writeSequence(const Scene& scene, const std::filesystem::path& folder, const WriteOptions& options);

}  // namespace motorcade::synth
