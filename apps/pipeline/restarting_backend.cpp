#include "apps/pipeline/restarting_backend.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace motorcade {

RestartingBackend::RestartingBackend(std::function<std::unique_ptr<Backend>()> make)
    : make_(std::move(make)), backend_(make_()) {}

EstimatesPtr RestartingBackend::operator()(const FrameMeasurementsPtr& measurements) {
  try {
    return estimate(measurements);
  } catch (...) {
    giveUp(*measurements);
    throw;
  }
}

EstimatesPtr RestartingBackend::estimate(const FrameMeasurementsPtr& measurements) {
  if (!backend_) {
    backend_ = make_();
    T_world_start_ = (T_world_cam_ * measurements->odometry.T_previous_now).normalized();
    restarted_ = true;
  }
  EstimatesPtr estimates = (*backend_)(measurements);
  const std::size_t final_now = estimates->finals.size();
  if (restarted_) {
    Estimates moved = *estimates;
    moveToWorld(moved.online);
    for (auto* estimates_left : {&moved.finals, &moved.settled})
      for (FrameEstimate& estimate : *estimates_left) moveToWorld(estimate);
    moved.finals.insert(moved.finals.begin(), left_.begin(), left_.end());
    estimates = std::make_shared<const Estimates>(std::move(moved));
  }
  window_.push_back(estimates->online);
  // Nothing may fail from here on: the estimates are on their way.
  window_.erase(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(std::min(final_now, window_.size())));
  left_.clear();
  T_world_cam_ = estimates->online.T_world_cam;
  return estimates;
}

std::vector<FrameEstimate> RestartingBackend::finish() {
  std::vector<FrameEstimate> finals(left_.begin(), left_.end());
  try {
    if (backend_)
      for (FrameEstimate& estimate : backend_->finish()) {
        moveToWorld(estimate);
        finals.push_back(std::move(estimate));
      }
  } catch (...) {
    finals.assign(left_.begin(), left_.end());
    finals.insert(finals.end(), window_.begin(), window_.end());
  }
  return finals;
}

/// Moves an estimate to the world. Covariances are relative to the camera and stay, but for that of its own pose: the
/// new start differs from the old world's.
void RestartingBackend::moveToWorld(FrameEstimate& estimate) const {
  if (!restarted_) return;
  estimate.T_world_cam = T_world_start_ * estimate.T_world_cam;
  estimate.camera_covariances.pose.reset();
  for (ObjectEstimate& object : estimate.objects) {
    object.T_world_body = T_world_start_ * object.T_world_body;
    const Eigen::Matrix3d& R_world_start = T_world_start_.rotation();
    object.velocity_world_mps = R_world_start * object.velocity_world_mps;
    if (object.velocity_covariance)
      object.velocity_covariance = R_world_start * *object.velocity_covariance * R_world_start.transpose();
  }
}

void RestartingBackend::giveUp(const FrameMeasurements& measurements) noexcept {
  backend_.reset();
  T_world_cam_ = (T_world_cam_ * measurements.odometry.T_previous_now).normalized();
  if (left_.empty()) left_.swap(window_);  // the window of a back-end that fails with its first frame is empty
}

}  // namespace motorcade
