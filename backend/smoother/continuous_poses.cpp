#include "backend/smoother/continuous_poses.hpp"

#include <cmath>
#include <utility>

#include "core/elementary.hpp"

namespace motorcade {

void ContinuousPoses::operator()(FrameEstimate& online, const EarlierPose& earlier) {
  std::map<TrackId, Published> published;
  for (ObjectEstimate& object : online.objects) {
    const auto last = last_.find(object.track);
    const auto then =
        last == last_.end() || !(correction_s_ > 0) ? std::nullopt : earlier(object.track, last->second.frame);
    if (then) {
      const SE3 predicted = object.T_world_body * then->inverse() * last->second.T_world_body;
      const double share = 1 - exponential(-secondsBetween(last->second.stamp, online.stamp) / correction_s_);
      const Vector6d correction = (predicted.inverse() * object.T_world_body).log();
      object.T_world_body = (predicted * SE3::exp(share * correction)).normalized();
    }
    published[object.track] = {online.frame, online.stamp, object.T_world_body};
  }
  last_ = std::move(published);
}

}  // namespace motorcade
