#include "apps/view/replay_gate.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace motorcade {

struct ReplayGate::State {
  std::function<bool()> deserted;
  std::mutex mutex{};
  std::condition_variable_any changed{};
  bool paused = false;
  int steps = 0;  // pairs that may pass while it is paused
};

ReplayGate::ReplayGate(std::function<bool()> deserted) : state_(new State{.deserted = std::move(deserted)}) {}
ReplayGate::~ReplayGate() = default;

void ReplayGate::pause() {
  const std::scoped_lock lock(state_->mutex);
  state_->paused = true;
}

void ReplayGate::resume() {
  {
    const std::scoped_lock lock(state_->mutex);
    state_->paused = false;
    state_->steps = 0;
  }
  state_->changed.notify_all();
}

void ReplayGate::step() {
  {
    const std::scoped_lock lock(state_->mutex);
    state_->paused = true;
    ++state_->steps;
  }
  state_->changed.notify_all();
}

bool ReplayGate::paused() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->paused;
}

SteadyTime::duration ReplayGate::pass(const std::stop_token& stopped) {
  constexpr std::chrono::milliseconds kPatience(250);
  std::unique_lock lock(state_->mutex);
  if (!state_->paused) return {};
  const auto begin = std::chrono::steady_clock::now();
  const auto open = [this] { return !state_->paused || state_->steps > 0; };
  while (!state_->changed.wait_for(lock, stopped, kPatience, open) && !stopped.stop_requested())
    if (state_->deserted()) state_->paused = false;
  if (state_->paused && state_->steps > 0) --state_->steps;
  return std::chrono::steady_clock::now() - begin;
}

}  // namespace motorcade
