#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include "apps/inject/fault_spec.hpp"
#include "core/image.hpp"
#include "core/messages.hpp"
#include "core/timestamp.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Stands between a sequence and its reader, and injects the faults of a specification. Results depend on the
/// specification and its seed alone. Call it in the order of frames, from one thread.
class FaultInjector {
 public:
  /// The receiver of pairs.
  struct Outlet {
    std::function<bool(StereoFrame)> push;              // false when no further pair is wanted
    std::function<void(FrameId, Timestamp)> pass_over;  // this pair does not come, or not in its turn
    std::function<void(std::chrono::duration<double>)> wait;
  };
  /// `sequence` must outlive it: faults of files read them again.
  FaultInjector(FaultSpec spec, const Sequence& sequence);

  /// Passes a pair on: changed, later or not at all. Returns false when no further pair is wanted.
  bool give(StereoFrame frame, const Outlet& outlet);
  /// Passes on the pairs that are still late; call it after the last pair.
  bool finish(const Outlet& outlet);
  /// The frame's time with all jumps so far.
  Timestamp shifted(Timestamp stamp) const { return {stamp.ns + jumps_ns_}; }

 private:
  struct Late {
    StereoFrame frame;
    std::int64_t after = 0;  // the frame that overtakes it
  };
  void applyTo(StereoFrame& frame, const Fault& fault, std::uint64_t seed);
  struct ImageOf {
    FrameId frame;
    StereoSide side;
  };
  void applyTo(Image& image, const ImageOf& of, const Fault& fault, std::uint64_t seed);
  void takeEarlierRight(StereoFrame& frame, std::size_t pairs_before) const;
  /// Reads the image of a file, whose bytes are damaged first; streams have none.
  Image readAgain(const ImageOf& of, const std::function<std::string(std::string)>& damage);
  bool giveLate(std::int64_t frame, const Outlet& outlet);

  FaultSpec spec_;
  const Sequence& sequence_;
  ImagePool pool_;
  std::optional<PairReader> reader_;  // made for the first fault of a file
  std::int64_t jumps_ns_ = 0;
  Image left_before_, right_before_;  // as they were given on
  std::deque<Image> rights_taken_;    // as the camera took them before, the newest first
  std::size_t kept_;                  // of them
  std::deque<Late> late_;
};

}  // namespace motorcade
