#include "camera_thread.hpp"

#include <utility>

namespace vehicle_stack {

CameraThread::CameraThread(Next next, motorcade::Tracker& tracker, HealthMonitor& health)
    : next_(std::move(next)),
      tracker_(tracker),
      health_(health),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void CameraThread::run(const std::stop_token& stop) {
  try {
    while (const auto pair = next_(stop)) {
      const motorcade::Tracker::Push outcome = tracker_.push(*pair);
      health_.pushed(std::chrono::steady_clock::now(), outcome.status);
    }
  } catch (const std::exception& error) {
    problem_ = error.what();
  }
  tracker_.close();
  ended_ = true;
}

void CameraThread::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

}  // namespace vehicle_stack
