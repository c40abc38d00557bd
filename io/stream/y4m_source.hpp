#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/image.hpp"
#include "core/mailbox.hpp"
#include "core/spsc_ring.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/inputs/pair_source.hpp"
#include "io/sequence/sequence.hpp"
#include "io/stream/stereo_packing.hpp"
#include "io/stream/y4m_header.hpp"
#include "io/stream/y4m_stream.hpp"

namespace motorcade {

/// A stream's drive as known before its first pair: all but the frames and their times. A pipe brings no calibration:
/// the user gives it. Throws InputError or UsageError.
Sequence sequenceOfStream(const Y4mHeader& header, StereoPacking packing, const GivenCameras& given);

/// The pairs of a YUV4MPEG2 stream, read and rectified on a thread of its own as they come. Either no pair is lost, and
/// the stream's writer waits where pairs are taken too slowly. Or the writer waits at most as long as a pair takes to
/// be rectified, and the newest pair is taken.
class Y4mSource final : public PairSource {
 public:
  struct Params {
    StereoPacking packing = StereoPacking::kSideBySide;
    FrameRange range{};     // pairs before it are read and left out; the stream may end before its end
    double rate_hz = 10;    // times are a pair's number by this rate
    bool newest = false;    // others are left out; a pair is due when it is decoded
    std::size_t ahead = 8;  // pairs, rounded up to a power of two
    FrameInputs inputs{};   // come with each pair
  };
  /// `sequence` is what `sequenceOfStream` tells.
  Y4mSource(std::unique_ptr<Y4mStream> stream, const Sequence& sequence, const Params& params);
  ~Y4mSource() override;
  Y4mSource(const Y4mSource&) = delete;
  Y4mSource& operator=(const Y4mSource&) = delete;

  std::optional<StereoFrame> next() override { return params_.newest ? newest_.take() : ring_.pop(); }
  void stop() override;
  SourceEnd finish() override;

  FrameId first() const override { return {static_cast<std::int64_t>(params_.range.begin)}; }
  Timestamp stampOf(FrameId frame) const override;
  double shareOutside() const override { return reader_.shareOutside(); }
  std::size_t highWater() const override { return params_.newest ? 1 : ring_.highWater(); }
  std::size_t capacity() const override { return params_.newest ? 1 : ring_.capacity(); }

 private:
  SourceEnd readAll();
  SourceEnd endAfter(std::size_t pairs, Y4mStream::Next why) const;
  StereoFrame decode(std::size_t index);
  bool give(StereoFrame frame);

  std::unique_ptr<Y4mStream> stream_;
  ImageSize size_;
  Params params_;
  PairReader reader_;
  ImagePool pool_;
  std::vector<std::uint8_t> luma_;
  SpscRing<StereoFrame> ring_;
  Mailbox<StereoFrame> newest_;
  SourceEnd end_;        // the thread's, until it has ended
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace motorcade
