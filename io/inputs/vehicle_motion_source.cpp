#include "io/inputs/vehicle_motion_source.hpp"

#include <utility>

namespace motorcade {

/// All samples may come at once, before the first pair.
VehicleMotionSource::VehicleMotionSource(std::unique_ptr<PairSource> pairs, std::vector<VehicleMotionSample> samples)
    : pairs_(std::move(pairs)),
      samples_(std::move(samples)),
      log_(std::make_shared<VehicleMotionLog>(samples_.size() + 1)) {}

std::optional<StereoFrame> VehicleMotionSource::next() {
  auto frame = pairs_->next();
  if (!frame) return frame;
  for (; next_ < samples_.size() && samples_[next_].stamp <= frame->head.stamp; ++next_) log_->add(samples_[next_]);
  frame->inputs.vehicle_motion = log_;
  frame->inputs.vehicle_samples = next_;
  return frame;
}

}  // namespace motorcade
