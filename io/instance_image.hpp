#pragma once

#include <filesystem>

#include "core/ids.hpp"
#include "io/image_file.hpp"

/// True masks of objects: the number of the label plus one, 0 for the background.
namespace motorcade {

/// The file of a frame's instances in their folder: NNNNNN.png of rendered drives, instancegt_NNNNN.png of Virtual
/// KITTI 2.
std::filesystem::path instanceFile(const std::filesystem::path& folder, FrameId frame);

/// Values of a gray PNG, or indices of one with a palette. Throws InputError naming the file.
Gray16Image readInstances(const std::filesystem::path& file);

}  // namespace motorcade
