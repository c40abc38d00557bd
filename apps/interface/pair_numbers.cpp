#include "apps/interface/pair_numbers.hpp"

#include "apps/pipeline/frame_clock.hpp"

namespace motorcade {

FrameId PairNumbers::read(FrameId given) {
  const std::int64_t ahead = ahead_.load(std::memory_order_relaxed);
  FrameId number = given.valid() ? FrameId{given.value + ahead} : next_;
  if (number < next_) {
    if (!goesOn(given)) return number;
    ahead_.store(next_.value - given.value, std::memory_order_relaxed);
    number = next_;
  }
  refused_ = 0;
  next_ = {number.value + 1};
  return number;
}

/// True when enough pairs were refused before this one, each after its predecessor. The limit keeps sums in range.
bool PairNumbers::goesOn(FrameId given) {
  constexpr std::int64_t kMost = std::int64_t{1} << 61;
  const bool in_order = refused_ > 0 && given > last_refused_;
  if (in_order && refused_ >= FrameClock::kRefused && next_.value <= kMost) return true;
  refused_ = in_order ? refused_ + 1 : 1;
  last_refused_ = given;
  return false;
}

std::optional<std::string> PairNumbers::news() {
  const std::int64_t ahead = ahead_.load(std::memory_order_relaxed);
  if (ahead == told_ahead_) return std::nullopt;
  told_ahead_ = ahead;
  return "the numbers of the pairs were set back; from here on those of frames are " + std::to_string(ahead) +
         " above them";
}

}  // namespace motorcade
