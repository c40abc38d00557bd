#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/ids.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Faults between a camera and the pipeline.
enum class FaultKind {
  kDrop,       // the pair never comes
  kDuplicate,  // it has the images of the pair before
  kLate,       // it comes so many pairs later
  kBlack,
  kWhite,
  kBlur,         // box of so many pixels each way
  kNoise,        // Gaussian, gray levels
  kExposure,     // gray levels times so much
  kJpeg,         // compressed at this quality
  kTruncated,    // only this share of the file's bytes is there
  kBitFlips,     // so many bits of the file are wrong
  kExchanged,    // left is right
  kApart,        // the right image is that of so many pairs before
  kLowered,      // the content is so many pixels lower
  kRolled,       // turned by so many degrees
  kZoomed,       // larger by so many percent
  kBarrel,       // radial distortion
  kOneEyed,      // one image does not come
  kStall,        // nothing comes for so many seconds, then the rest at once
  kTimeJump,     // times are so many seconds later from here on
  kOutOfMemory,  // from here on the process gets so many more megabytes and no more
  kDiskFull,     // from here on no file grows beyond so many kilobytes
  kDiskStall     // the disk takes its results so many seconds later
};

enum class FaultSide { kBoth, kLeft, kRight };

/// One fault, and the frames that it affects.
struct Fault {
  FaultKind kind = FaultKind::kDrop;
  double value = 0;  // see FaultKind; kinds without a value ignore it
  FaultSide side = FaultSide::kBoth;
  FrameRange frames{};
  std::size_t step = 1;  // every so many of them
  double share = 1;      // and of these only so many, at random
};

struct FaultSpec {
  std::vector<Fault> faults;
  std::uint64_t seed = 1;
};

/// Reads faults, separated by commas: KIND[=VALUE][/left|/right][@A[:B[:STEP]]][~SHARE], or seed=N. Frames are numbered
/// as in the sequence; a fault without frames affects all of them. `late` is also called `reordered` where the value is
/// 1. Example: `black@20:23,noise=20~0.1,blur=9/right@::2`. Throws UsageError that names the part.
FaultSpec parseFaultSpec(std::string_view text);

/// A line per kind: its name, value and meaning, for `--help` and messages.
std::string faultHelp();

/// True if the fault affects this frame. The answer depends only on the arguments.
bool strikes(const Fault& fault, std::size_t index_of_fault, FrameId frame, std::uint64_t seed);

/// Time for which the disk stalls before it takes the frame's results; 0 where it does not.  [s]
double diskStall_s(const FaultSpec& spec, FrameId frame);

/// A seed for the random part of a fault in a frame.
std::uint64_t seedOf(std::uint64_t seed, std::size_t index_of_fault, FrameId frame);

}  // namespace motorcade
