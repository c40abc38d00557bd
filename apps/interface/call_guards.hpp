#pragma once

#include <atomic>
#include <exception>
#include <string>

#include "apps/pipeline/log_callback.hpp"

namespace motorcade {

/// Holds off a second thread that pushes at the same time.
class OneAtATime {
 public:
  explicit OneAtATime(std::atomic_flag& busy) : busy_(busy), entered_(!busy.test_and_set(std::memory_order_acquire)) {}
  ~OneAtATime() {
    if (entered_) busy_.clear(std::memory_order_release);
  }
  OneAtATime(const OneAtATime&) = delete;
  OneAtATime& operator=(const OneAtATime&) = delete;
  bool entered() const { return entered_; }

 private:
  std::atomic_flag& busy_;
  bool entered_;
};

/// A call that is under way. The tracker outlives it.
class Visit {
 public:
  explicit Visit(std::atomic<int>& visits) : visits_(visits) { ++visits_; }
  ~Visit() { --visits_; }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

 private:
  std::atomic<int>& visits_;
};

/// Calls a callback for `what`. Its exceptions are logged and do not prevent the next call.
template <class Call>
void callLogged(const LogCallback& log, const char* what, const Call& call) {
  const auto complain = [&](const char* why) {
    tell(log, LogLevel::kError, [&] { return std::string("the callback for ") + what + ": " + why; });
  };
  try {
    call();
  } catch (const std::exception& error) {
    complain(error.what());
  } catch (...) {
    complain("it threw what is no std::exception");
  }
}

}  // namespace motorcade
