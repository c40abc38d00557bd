#include "backend/window/continuous_poses.hpp"

#include <cmath>
#include <utility>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

constexpr double kCameraShare = 0.3;  // of the time: what is found out of the camera's path is less

}  // namespace

void ContinuousPoses::operator()(FrameEstimate& online, const EarlierPoses& earlier) {
  const SE3 T_world_cam = online.T_world_cam;
  continueCamera(online, earlier);
  const SE3 shift = online.T_world_cam * T_world_cam.inverse();
  std::map<TrackId, Published> published;
  for (ObjectEstimate& object : online.objects) {
    const auto last = last_.find(object.track);
    const auto then =
        last == last_.end() || !(correction_s_ > 0) ? std::nullopt : earlier.object(object.track, last->second.frame);
    const SE3 now = object.T_world_body, target = shift * now;
    object.T_world_body = then ? continued(last->second, *then, now, target, online.head.stamp, correction_s_) : target;
    published[object.track] = {online.head.frame, online.head.stamp, object.T_world_body};
  }
  last_ = std::move(published);
}

void ContinuousPoses::continueCamera(FrameEstimate& online, const EarlierPoses& earlier) {
  const auto then = last_camera_ && correction_s_ > 0 ? earlier.camera(last_camera_->frame) : std::nullopt;
  const SE3 now = online.T_world_cam;
  if (then)
    online.T_world_cam = continued(*last_camera_, *then, now, now, online.head.stamp, kCameraShare * correction_s_);
  last_camera_ = {online.head.frame, online.head.stamp, online.T_world_cam};
}

/// The published pose, moved on from `then` to `now`, and a share of the way to `target`.
SE3 ContinuousPoses::continued(const Published& last, const SE3& then, const SE3& now, const SE3& target,
                               Timestamp stamp, double correction_s) const {
  const SE3 predicted = now * then.inverse() * last.T_world;
  const double share = 1 - exponential(-secondsBetween(last.stamp, stamp) / correction_s);
  const Vector6d correction = (predicted.inverse() * target).log();
  return (predicted * SE3::exp(share * correction)).normalized();
}

}  // namespace motorcade
