#pragma once

#include <filesystem>

#include "core/ids.hpp"
#include "io/images/image_file.hpp"

/// Images of instances: one number for the pixels of one body, 0 for the background. In true masks the number is that
/// of the label plus one.
namespace motorcade {

/// The file of a frame's instances in their folder: NNNNNN.png of rendered drives, instancegt_NNNNN.png of Virtual
/// KITTI 2.
std::filesystem::path instanceFile(const std::filesystem::path& folder, FrameId frame);

/// Does a file have such a name?
bool isInstanceFile(const std::filesystem::path& file);

/// Values of a gray PNG, or indices of one with a palette. Throws InputError naming the file.
Gray16Image readInstances(const std::filesystem::path& file);

}  // namespace motorcade
