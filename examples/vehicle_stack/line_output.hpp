#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace vehicle_stack {

/// Publishes lines to a file descriptor without ever being held up for long by a reader that is slow: such a line is
/// left out and counted. Any thread may call it.
///
/// To be replaced by the vehicle's middleware; `publish` is the one call that the stack makes.
class LineOutput {
 public:
  explicit LineOutput(int descriptor) : descriptor_(descriptor) {}

  /// A line of at most 4096 bytes (PIPE_BUF) goes into a pipe whole or not at all.
  void publish(const std::string& line);

  bool readerIsGone() const { return gone_; }
  std::int64_t leftOut() const { return left_out_; }

 private:
  int descriptor_;
  std::mutex mutex_;
  std::atomic<bool> gone_ = false;
  std::atomic<std::int64_t> left_out_ = 0;
};

}  // namespace vehicle_stack
