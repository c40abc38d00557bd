#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "core/timestamp.hpp"

namespace motorcade {

/// Motion of the middle of the vehicle's rear axle at one moment, by its own sensors, such as wheel speed and yaw rate
/// on its bus.
struct VehicleMotionSample {
  Timestamp stamp;
  double speed_mps = 0;        // ahead; negative in reverse
  double yaw_rate_radps = 0;   // about the upward axis: positive to the left
  double speed_sigma_mps = 0;  // standard deviations; 0: found out while the camera sees
  double yaw_rate_sigma_radps = 0;
};

/// Samples in the order in which they came, numbered from 0, for readers in other threads. Only the newest ones are
/// held; adding does not use the heap.
class VehicleMotionLog {
 public:
  explicit VehicleMotionLog(std::size_t capacity = 4096) : ring_(capacity) {}

  void add(const VehicleMotionSample& sample);
  /// The number of samples added so far; takes no lock.
  std::uint64_t count() const { return count_.load(std::memory_order_acquire); }
  /// The samples from `begin` up to, but not including, `end`, as far as they are still held.
  std::vector<VehicleMotionSample> read(std::uint64_t begin, std::uint64_t end) const;

 private:
  mutable std::mutex mutex_;
  std::vector<VehicleMotionSample> ring_;
  std::atomic<std::uint64_t> count_{0};  // changes under the mutex
};

}  // namespace motorcade
