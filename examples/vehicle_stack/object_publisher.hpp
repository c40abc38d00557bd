#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include <motorcade/motorcade.hpp>

#include "health_monitor.hpp"
#include "trust.hpp"
#include "vehicle_frame.hpp"

namespace vehicle_stack {

/// Publishes results in the vehicle frame, one line of JSON each: `frame` with the vehicle's motion, then an `object`
/// for each object, and between them `health`, with the objects that are stale when the level becomes blind.
class ObjectPublisher {
 public:
  using Publish = std::function<void(const std::string& line)>;

  /// A message may be used for `valid_for` after its stamp.
  ObjectPublisher(const VehicleFrame& frame, std::chrono::milliseconds valid_for, Publish publish);

  /// Consumer thread.
  void publish(const motorcade::Result& result, Level level);
  /// Watchdog thread. The reason is empty where the level has not changed.
  void publish(const HealthMonitor& health, const motorcade::Tracker::Counts& counts, const std::string& reason);

 private:
  void publishObject(const motorcade::Result& result, const motorcade::Result::Object& object, Trust in_frame);
  std::vector<std::int64_t> takeStale(Level level);

  VehicleFrame frame_;
  std::int64_t valid_for_ms_;
  Publish publish_;
  std::mutex mutex_;
  std::vector<std::int64_t> published_;  // objects of the last frame that were not stale
};

}  // namespace vehicle_stack
