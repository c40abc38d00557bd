#pragma once

#include <chrono>
#include <cstddef>

namespace motorcade {

/// Shows how far a run is: a bar on a terminal, a plain line every few seconds otherwise. Writes to the standard error
/// output.
class Progress {
 public:
  explicit Progress(std::size_t frames);
  /// Ends the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// So many frames are out, the newest one after this latency.
  void show(std::size_t done, double latency_ms);

 private:
  using Clock = std::chrono::steady_clock;
  std::size_t frames_;
  bool terminal_;
  Clock::time_point start_, next_;
  bool line_open_ = false;
};

}  // namespace motorcade
