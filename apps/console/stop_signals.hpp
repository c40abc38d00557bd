#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

namespace motorcade {

inline constexpr int kExitSignal = 128;  // plus the signal that ended the program, as shells have it

/// Waits for SIGINT and SIGTERM on a thread of its own, so that the work can end in order. A second signal ends the
/// program at once, unless it comes within a second: `timeout` and terminals send the same one to a process and to its
/// group. Create it before other threads: they inherit that both signals are blocked.
class StopSignals {
 public:
  StopSignals();
  /// Leaves both signals blocked after one came: the program is about to end in order.
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Starts a thread that calls `stop`, once, when a signal comes; watching ends with that thread.
  [[nodiscard]] std::jthread watch(std::function<void()> stop);
  /// The received signal, 0 when there was none.
  int received() const { return received_.load(); }

 private:
  /// The next signal within that time, or not a positive number.
  int next(std::chrono::milliseconds patience) const;

  sigset_t signals_, before_;
  std::atomic<int> received_{0};
};

}  // namespace motorcade
