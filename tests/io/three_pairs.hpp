#pragma once

#include <cstdint>
#include <optional>

#include "io/inputs/pair_source.hpp"

namespace motorcade::test {

/// Three pairs without images.
class ThreePairs final : public PairSource {
 public:
  std::optional<StereoFrame> next() override {
    if (next_ == 3) return std::nullopt;
    StereoFrame frame;
    frame.head = {.frame = {next_}, .stamp = stampOf({next_})};
    ++next_;
    return frame;
  }
  void stop() override { next_ = 3; }
  SourceEnd finish() override { return {.remark = "the end"}; }
  FrameId first() const override { return {0}; }
  Timestamp stampOf(FrameId frame) const override { return {100 * frame.value}; }
  double shareOutside() const override { return 0.25; }
  std::size_t highWater() const override { return 2; }
  std::size_t capacity() const override { return 4; }

 private:
  std::int64_t next_ = 0;
};

}  // namespace motorcade::test
