#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/messages.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade::perf {

/// Continuation of a sequence after its last frame, so that the images stay continuous.
enum class Looping {
  kForthAndBack,  // 0 1 2 3 2 1 0 1 ...: for any drive
  kRound,         // 0 1 2 3 0 1 2 3 ...: for a drive that ends where it begins
};

/// A drive of `frames` pairs out of the frames of a shorter sequence. The first pass keeps its stamps; later passes
/// continue at the mean rate.
Sequence looped(const Sequence& sequence, std::size_t frames, Looping looping);

/// Gives a drive's frames one after the other, without due times; empty at its end.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual std::optional<StereoFrame> next() = 0;
};

/// All images of a drive, decoded once and held: each file once, however often the drive shows it.
class HeldDrive {
 public:
  /// Throws InputError when an image cannot be read: a benchmark wants whole drives.
  explicit HeldDrive(const Sequence& drive);

  std::size_t size() const { return frames_.size(); }
  const StereoFrame& frame(std::size_t index) const { return frames_[index]; }

 private:
  std::vector<StereoFrame> frames_;  // copies share their pixels
};

/// Plays from memory; `drive` must outlive the source.
std::unique_ptr<FrameSource> playHeld(const HeldDrive& drive);
/// Decodes while it plays, up to `ahead` pairs ahead, as `motorcade run` does.
std::unique_ptr<FrameSource> playFromDisk(const Sequence& drive, std::size_t ahead);

/// CPU time of decoding a pair [ms], measured on at most the drive's first 200 pairs while nothing else runs in the
/// process.
double decodingCpu_ms(const Sequence& drive);

/// Unit of costs: CPU time per pair in which libpng alone decodes the drive's images [ms]. Machines differ by a factor
/// of two, costs in units hardly. Empty for images that are no PNGs.
std::optional<double> unit_ms(const Sequence& drive);

}  // namespace motorcade::perf
