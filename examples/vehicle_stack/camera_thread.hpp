#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include <motorcade/motorcade.hpp>

#include "health_monitor.hpp"

namespace vehicle_stack {

/// The one thread that pushes: hands each pair of the camera to the tracker, and closes the tracker at the end.
/// `push` copies the pixels and never waits under the live policy, so that the camera's buffers are free at once.
class CameraThread {
 public:
  /// Waits for the next pair; empty at the end, and soon after a request to stop. May throw when the camera fails.
  using Next = std::function<std::optional<motorcade::Pair>(const std::stop_token&)>;

  /// Starts at once. `tracker` and `health` must outlive this.
  CameraThread(Next next, motorcade::Tracker& tracker, HealthMonitor& health);

  bool ended() const { return ended_; }
  /// Waits for the thread to end, as soon as `next` returns.
  void stop();
  /// After `stop`: why the camera failed, empty when it did not.
  const std::string& problem() const { return problem_; }

 private:
  void run(const std::stop_token& stop);

  Next next_;
  motorcade::Tracker& tracker_;
  HealthMonitor& health_;
  std::string problem_;
  std::atomic<bool> ended_ = false;
  std::jthread thread_;  // last: what it uses is there before it starts
};

}  // namespace vehicle_stack
