#pragma once

#include <functional>
#include <memory>
#include <stop_token>

#include "core/messages.hpp"

namespace motorcade {

/// Holds a replay when a viewer asks for it: pause, one pair more, go on. Any thread may ask; the replay's own thread
/// passes before each pair. Every wait has an end: when the replay is stopped, and when no viewer is left who could let
/// it go on.
class ReplayGate {
 public:
  /// `deserted` is asked now and then while the replay is held.
  explicit ReplayGate(std::function<bool()> deserted);
  ~ReplayGate();
  ReplayGate(const ReplayGate&) = delete;
  ReplayGate& operator=(const ReplayGate&) = delete;

  void pause();
  void resume();
  /// Lets one pair through, and holds the next.
  void step();
  bool paused() const;

  /// Waits while the replay is held, and returns how long that was.
  SteadyTime::duration pass(const std::stop_token& stopped);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace motorcade
