#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/ids.hpp"
#include "core/messages.hpp"
#include "io/images/image_file.hpp"

/// Images with one number for the pixels of one body, 0 for the background: masks that a run writes, and instances. In
/// true masks the number is that of the label plus one.
namespace motorcade {

/// The folder of masks within a run folder.
inline constexpr const char* kMasksFolder = "masks";

/// The image that `run --masks` writes for one frame. A pixel is 0 where nothing moves or nothing is known, else the
/// number of the track plus one. Where several objects overlap, the nearest is shown.
Gray16Image maskImage(const FrameEstimate& frame, const std::vector<ObjectMask>& masks, int width_px, int height_px);

/// The value of a track's pixels there.
std::uint16_t maskValue(TrackId track);

/// The track that a pixel of such an image shows, which must not be 0.
TrackId trackOfMask(std::uint16_t value);

/// The file of a frame's mask in the folder.
std::filesystem::path maskFile(const std::filesystem::path& folder, FrameId frame);
/// Does a file have such a name?
bool isMaskFile(const std::filesystem::path& file);

/// The file of a frame's instances in their folder: NNNNNN.png of rendered drives, instancegt_NNNNN.png of Virtual
/// KITTI 2.
std::filesystem::path instanceFile(const std::filesystem::path& folder, FrameId frame);

/// Does a file have such a name?
bool isInstanceFile(const std::filesystem::path& file);

/// Values of a gray PNG, or indices of one with a palette. Throws InputError naming the file.
Gray16Image readInstances(const std::filesystem::path& file);

}  // namespace motorcade
