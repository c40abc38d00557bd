#include "apps/run/stop_signals.hpp"

#include <ctime>
#include <utility>

namespace motorcade {

StopSignals::StopSignals() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

StopSignals::~StopSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

std::jthread StopSignals::watch(std::function<void()> stop) {
  return std::jthread([this, stop = std::move(stop)](const std::stop_token& ended) {
    while (!ended.stop_requested()) {
      constexpr timespec kPatience{.tv_sec = 0, .tv_nsec = 100'000'000};
      const int signal = sigtimedwait(&signals_, nullptr, &kPatience);
      if (signal <= 0) continue;
      received_ = signal;
      pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);  // from now on this thread takes a signal's usual end
      stop();
      return;
    }
  });
}

}  // namespace motorcade
