#include "apps/console/stop_signals.hpp"

#include <ctime>
#include <utility>

namespace motorcade {

using namespace std::chrono_literals;

StopSignals::StopSignals() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

StopSignals::~StopSignals() {
  if (received_ == 0) pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

int StopSignals::next(std::chrono::milliseconds patience) const {
  const timespec wait{.tv_sec = patience.count() / 1000, .tv_nsec = patience.count() % 1000 * 1'000'000};
  return sigtimedwait(&signals_, nullptr, &wait);
}

std::jthread StopSignals::watch(std::function<void()> stop) {
  return std::jthread([this, stop = std::move(stop)](const std::stop_token& ended) {
    while (!ended.stop_requested() && received_ == 0)
      if (const int signal = next(100ms); signal > 0) received_ = signal;
    if (received_ == 0) return;
    stop();
    const auto repeated_until = std::chrono::steady_clock::now() + 1s;
    while (!ended.stop_requested() && std::chrono::steady_clock::now() < repeated_until) next(50ms);
    if (!ended.stop_requested())
      pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);  // from now on a signal has its usual end here
    while (!ended.stop_requested()) std::this_thread::sleep_for(50ms);
  });
}

}  // namespace motorcade
