#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/se3.hpp"
#include "core/timestamp.hpp"
#include "io/sequence/sequence.hpp"

/// Files with a line per image beside a sequence that lacks images. They may have a line for each number of the
/// complete numbering, for each left image, for each right one or for each pair.
namespace motorcade {

/// The place of a frame in the complete numbering of its images.
std::int64_t placeOf(const Sequence& sequence, std::size_t frame);
/// Every frame has its images, and their numbers have no gap.
bool isComplete(const Sequence& sequence);

/// The frame of each line, or -1 where there is none.
using FramesOfLines = std::vector<std::int64_t>;
/// All ways in which `lines` lines may belong to the frames, the likeliest first.
std::vector<FramesOfLines> waysToRead(const Sequence& sequence, std::size_t lines);
/// True if lines are assigned by the images' numbers: images are missing, or the lines begin before the first image.
bool linesBelongToNumbers(const Sequence& sequence, std::size_t lines);
/// The likeliest of them. Throws InputError that says what the file has and what is needed; `what` is a plural noun.
FramesOfLines framesOfLines(const Sequence& sequence, std::size_t lines, const std::filesystem::path& file,
                            const std::string& what);

/// Sets the stamps of all frames from the times of a file's lines; those of frames without a line are interpolated.
/// Frames that both sides lack are removed if the times have no gap there. Throws InputError if it is uncertain which
/// images the times belong to.
void setStampsOfLines(Sequence& sequence, const std::vector<Timestamp>& times, const std::filesystem::path& file);

/// The poses of all frames from those of a file's lines; those of frames without a line are interpolated.
std::vector<SE3> posesOfFrames(const Sequence& sequence, const std::vector<SE3>& poses,
                               const std::filesystem::path& file);

/// Adds a note where images are so far apart, or so close together, that the times cannot be right.
void tellPeriod(Sequence& sequence);

}  // namespace motorcade
