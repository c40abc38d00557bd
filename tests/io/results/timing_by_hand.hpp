#pragma once

#include <chrono>

#include "core/frame_timing.hpp"

namespace motorcade::test {

/// Timing of the i-th frame at ten frames a second, in which each stage takes 3 ms.
inline FrameTiming timingOf(int i) {
  FrameTiming timing;
  timing.head.frame = {i};
  timing.head.stamp = {i * 100'000'000LL};
  timing.due = SteadyTime(std::chrono::milliseconds(1000 + 100 * i));
  timing.admitted = timing.due + std::chrono::milliseconds(2);
  timing.decode_ms = 8;
  timing.decoded = timing.due - std::chrono::milliseconds(40);
  SteadyTime now = timing.admitted;
  for (StageSpan& span : timing.stages) {
    span = {now + std::chrono::milliseconds(1), now + std::chrono::milliseconds(4), i % 2, 2.5};
    now = span.end;
  }
  timing.published = now + std::chrono::milliseconds(1);
  timing.points = 300;
  timing.inliers = 250;
  timing.objects = 2;
  return timing;
}

}  // namespace motorcade::test
