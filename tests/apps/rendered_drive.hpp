#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "core/messages.hpp"
#include "io/images/image_file.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// A drive in memory.
struct Drive {
  StereoCamera camera;
  std::vector<StereoFrame> frames;
};

inline Drive readDrive(const std::filesystem::path& folder) {
  const Sequence sequence = openSequence(folder);
  Drive drive{.camera = sequence.camera, .frames = {}};
  ImagePool pool;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    StereoFrame frame;
    frame.head.frame = {static_cast<std::int64_t>(i)};
    frame.head.stamp = sequence.stamps[i];
    frame.left = readImage(sequence.frames[i].left, pool);
    frame.right = readImage(sequence.frames[i].right, pool);
    drive.frames.push_back(std::move(frame));
  }
  return drive;
}

}  // namespace motorcade
