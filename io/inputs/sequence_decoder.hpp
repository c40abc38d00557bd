#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>

#include "core/image.hpp"
#include "core/messages.hpp"
#include "core/spsc_ring.hpp"
#include "io/images/image_limits.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/inputs/pair_source.hpp"
#include "io/inputs/side_reader.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Decodes and rectifies a sequence's images on threads of its own, one per side, a bounded number of pairs ahead of
/// the consumer. Takes frames from one thread only. A pair that cannot be read, or has the wrong size, comes out
/// without images and with its `problem`.
class SequenceDecoder final : public PairSource {
 public:
  struct Params {
    std::size_t ahead = 8;  // pairs, rounded up to a power of two
    /// Asked, on the decoder's thread, before a pair is decoded; an unwanted pair is left out. The last pair always
    /// comes.
    std::function<bool(Timestamp)> wanted{};
    int max_file_mb = kMaxImageFile_mb;
    FrameInputs inputs{};  // come with each pair
  };
  SequenceDecoder(Sequence sequence, FrameRange range, const Params& params);
  SequenceDecoder(Sequence sequence, FrameRange range) : SequenceDecoder(std::move(sequence), range, Params{}) {}
  /// Stops decoding, whether or not all frames were taken.
  ~SequenceDecoder() override;
  SequenceDecoder(const SequenceDecoder&) = delete;
  SequenceDecoder& operator=(const SequenceDecoder&) = delete;

  /// Pairs are numbered by their index in the sequence and have no due time.
  std::optional<StereoFrame> next() override;
  void stop() override { ring_.close(); }
  SourceEnd finish() override;

  FrameId first() const override { return {static_cast<std::int64_t>(range_.begin)}; }
  Timestamp stampOf(FrameId frame) const override { return sequence_.stamps[frame.value]; }
  double shareOutside() const override { return reader_.shareOutside(); }
  std::size_t highWater() const override { return ring_.highWater(); }
  std::size_t capacity() const override { return ring_.capacity(); }

 private:
  void letThePairGoAhead() const;
  StereoFrame decode(std::size_t index);
  void readInto(StereoFrame& frame, const FramePaths& paths);
  bool wants(std::size_t index) const {
    return !wanted_ || index + 1 == range_.end || wanted_(sequence_.stamps[index]);
  }

  Sequence sequence_;
  std::function<bool(Timestamp)> wanted_;
  FrameInputs inputs_;
  FrameRange range_;
  PairReader reader_;
  SideReader right_;
  SpscRing<StereoFrame> ring_;
  std::atomic<SteadyTime::rep> taken_{0};  // when a pair was taken last
  std::jthread thread_;                    // last: it uses all of the above
};

}  // namespace motorcade
