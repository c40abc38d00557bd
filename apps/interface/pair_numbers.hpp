#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "core/ids.hpp"

namespace motorcade {

/// The numbers of pairs, which never go back, whatever the camera's counter does. As with stamps (`FrameClock`), a few
/// numbers in a row before the last one, but in order, show that the counter was set back. Numbers then go on from the
/// last one.
class PairNumbers {
 public:
  /// The number of a pair that the caller numbers so; the next one where it gives none. One that is not after the last
  /// is for the pipeline to refuse. Used by the pushing thread only.
  FrameId read(FrameId given);
  /// A sentence about numbers that were set back, once for each time. Used by the delivering thread only.
  std::optional<std::string> news();

 private:
  bool goesOn(FrameId given);

  FrameId next_{0};
  FrameId last_refused_;
  int refused_ = 0;                     // in a row, before the last one, with numbers in order
  std::atomic<std::int64_t> ahead_{0};  // from the caller's numbers to the pipeline's
  std::int64_t told_ahead_ = 0;
};

}  // namespace motorcade
