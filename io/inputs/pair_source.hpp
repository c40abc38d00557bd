#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/messages.hpp"

namespace motorcade {

/// The end of a source, with remarks for the user.
struct SourceEnd {
  std::string remark{};     // a sentence; empty where all pairs came
  bool damaged = false;     // what follows the last pair cannot be used, or there was none
  std::string instances{};  // what is wrong with the instance labels, a sentence; empty where nothing is
};

/// Stereo pairs as a run takes them: decoded, rectified and numbered, from a recorded drive, a pipe, or another source.
/// One thread takes the pairs.
class PairSource {
 public:
  virtual ~PairSource() = default;

  /// The next pair; waits for it. Its due time is set only where the source knows when it came. Empty after the last
  /// pair or after `stop`.
  virtual std::optional<StereoFrame> next() = 0;
  /// Ends the source early, from any thread; pairs already decoded still come out.
  virtual void stop() = 0;
  /// Stops, and waits until nothing more is read. Call it once, when no further pair is taken.
  virtual SourceEnd finish() = 0;

  /// The number of the first pair, unless it is left out.
  virtual FrameId first() const = 0;
  /// The time of any pair up to the last that came, also of one that was left out.
  virtual Timestamp stampOf(FrameId frame) const = 0;
  /// Share of the pixels that the camera did not see, of the image with more of them; 0 where nothing is rectified.
  virtual double shareOutside() const = 0;
  /// Most pairs ever waiting, and how many may. Final once `finish` has returned.
  virtual std::size_t highWater() const = 0;
  virtual std::size_t capacity() const = 0;
};

/// The pairs of another source, unchanged: a base for sources that add something to each pair.
class ForwardingSource : public PairSource {
 public:
  explicit ForwardingSource(std::unique_ptr<PairSource> pairs) : pairs_(std::move(pairs)) {}

  std::optional<StereoFrame> next() override { return pairs_->next(); }
  void stop() override { pairs_->stop(); }
  SourceEnd finish() override { return pairs_->finish(); }

  FrameId first() const override { return pairs_->first(); }
  Timestamp stampOf(FrameId frame) const override { return pairs_->stampOf(frame); }
  double shareOutside() const override { return pairs_->shareOutside(); }
  std::size_t highWater() const override { return pairs_->highWater(); }
  std::size_t capacity() const override { return pairs_->capacity(); }

 private:
  std::unique_ptr<PairSource> pairs_;
};

}  // namespace motorcade
