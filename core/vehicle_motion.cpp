#include "core/vehicle_motion.hpp"

#include <algorithm>

namespace motorcade {

void VehicleMotionLog::add(const VehicleMotionSample& sample) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t number = count_.load(std::memory_order_relaxed);
  ring_[number % ring_.size()] = sample;
  count_.store(number + 1, std::memory_order_release);
}

std::vector<VehicleMotionSample> VehicleMotionLog::read(std::uint64_t begin, std::uint64_t end) const {
  const std::lock_guard lock(mutex_);
  const std::uint64_t count = count_.load(std::memory_order_relaxed);
  end = std::min(end, count);
  if (count > ring_.size()) begin = std::max(begin, count - ring_.size());
  std::vector<VehicleMotionSample> samples;
  for (std::uint64_t number = begin; number < end; ++number) samples.push_back(ring_[number % ring_.size()]);
  return samples;
}

}  // namespace motorcade
