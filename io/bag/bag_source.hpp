#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/image.hpp"
#include "core/spsc_ring.hpp"
#include "io/bag/bag_drive.hpp"
#include "io/bag/bag_pairs.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/inputs/pair_source.hpp"

namespace motorcade {

/// The pairs of a bag, read, decoded and rectified on a thread of its own, a bounded number ahead of the consumer. A
/// pair that cannot be decoded comes out without images and with its `problem`. A damaged bag gives the pairs before
/// the damage.
class BagSource final : public PairSource {
 public:
  struct Params {
    FrameRange range{};     // pairs before it are read and left out; the bag may end before its end
    std::size_t ahead = 8;  // pairs, rounded up to a power of two
    /// Asked, on the source's thread, before a pair is decoded; an unwanted pair is left out.
    std::function<bool(Timestamp)> wanted{};
    FrameInputs inputs{};  // come with each pair
  };
  BagSource(const BagDrive& drive, const Params& params);
  ~BagSource() override;
  BagSource(const BagSource&) = delete;
  BagSource& operator=(const BagSource&) = delete;

  std::optional<StereoFrame> next() override { return ring_.pop(); }
  void stop() override;
  SourceEnd finish() override;

  FrameId first() const override { return {static_cast<std::int64_t>(params_.range.begin)}; }
  Timestamp stampOf(FrameId frame) const override;
  double shareOutside() const override { return reader_.shareOutside(); }
  std::size_t highWater() const override { return ring_.highWater(); }
  std::size_t capacity() const override { return ring_.capacity(); }

 private:
  SourceEnd readAll();
  SourceEnd endAfter(std::size_t pairs, const std::string& damage) const;
  bool give(std::size_t index, const BagPair& pair);
  StereoFrame decode(std::size_t index, const BagPair& pair);

  std::string name_;
  MessageConversion conversion_;
  Params params_;
  BagPairs pairs_;
  PairReader reader_;
  ImagePool pool_;
  SpscRing<StereoFrame> ring_;
  mutable std::mutex mutex_;
  std::vector<Timestamp> stamps_;  // of all pairs that came; under the mutex
  SourceEnd end_;                  // the thread's, until it has ended
  std::jthread thread_;            // last: it uses all of the above
};

}  // namespace motorcade
