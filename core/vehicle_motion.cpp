#include "core/vehicle_motion.hpp"

#include <algorithm>

namespace motorcade {

void VehicleMotionLog::add(const VehicleMotionSample& sample) {
  const std::lock_guard lock(mutex_);
  ring_[count_ % ring_.size()] = sample;
  ++count_;
}

std::uint64_t VehicleMotionLog::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

std::vector<VehicleMotionSample> VehicleMotionLog::read(std::uint64_t begin, std::uint64_t end) const {
  const std::lock_guard lock(mutex_);
  end = std::min(end, count_);
  if (count_ > ring_.size()) begin = std::max(begin, count_ - ring_.size());
  std::vector<VehicleMotionSample> samples;
  for (std::uint64_t number = begin; number < end; ++number) samples.push_back(ring_[number % ring_.size()]);
  return samples;
}

}  // namespace motorcade
