#include "frontend/motion/camera_trail.hpp"

namespace motorcade {

void CameraTrail::add(Timestamp stamp, const SE3& T_seen_now) {
  if (steps_.empty()) {
    steps_.push_back({0, stamp, SE3{}});
  } else {
    steps_.push_back({steps_.back().step + 1, stamp, (steps_.back().T_world_cam * T_seen_now).normalized()});
  }
  if (steps_.size() > kCapacity) steps_.erase(steps_.begin());
  const Step& now = steps_.back();
  relations_.clear();
  for (const auto& s : steps_)
    relations_.push_back({s.T_world_cam.inverse() * now.T_world_cam, secondsBetween(now.stamp, s.stamp)});
}

const CameraTrail::Relation* CameraTrail::find(std::int64_t step) const {
  if (steps_.empty() || step < steps_.front().step || step > steps_.back().step) return nullptr;
  return &relations_[step - steps_.front().step];
}

}  // namespace motorcade
