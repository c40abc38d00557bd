#include "backend/window/continuous_poses.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

constexpr double kCameraShare = 0.3;  // of the time: what is found out of the camera's path is less
constexpr std::size_t kCameras = 64;  // more than a motion's covariance spans

/// Covariance about the published pose instead of the estimated one, as a right perturbation.
void widen(std::optional<Matrix6d>& covariance, const SE3& published, const SE3& estimated) {
  if (!covariance) return;
  const Vector6d missing = (published.inverse() * estimated).log();
  *covariance += missing * missing.transpose();
}

}  // namespace

void ContinuousPoses::operator()(FrameEstimate& online, const EarlierPoses& earlier,
                                 std::optional<FrameId> motion_begin) {
  const SE3 T_world_cam = online.T_world_cam;
  if (endsGuess(online.head)) last_.clear();
  continueCamera(online, earlier);
  widenCamera(online.camera_covariances, T_world_cam, earlier, motion_begin);
  const SE3 shift = online.T_world_cam * T_world_cam.inverse();
  std::map<TrackId, Published> published;
  for (ObjectEstimate& object : online.objects) {
    const auto last = last_.find(object.track);
    const auto then = last == last_.end() || !(correction_s_ > 0)
                          ? std::nullopt
                          : earlier.object(object.track, last->second.head.frame);
    const SE3 now = object.T_world_body, target = shift * now;
    object.T_world_body = then ? continued(last->second, *then, now, target, online.head.stamp, correction_s_) : target;
    widen(object.covariance, object.T_world_body, target);
    published[object.track] = {online.head, object.T_world_body};
  }
  last_ = std::move(published);
}

bool ContinuousPoses::endsGuess(const FrameHead& now) const {
  return now.status == FrameStatus::kGood && !cameras_.empty() && cameras_.back().head.status != FrameStatus::kGood;
}

void ContinuousPoses::continueCamera(FrameEstimate& online, const EarlierPoses& earlier) {
  const bool goes_on = !cameras_.empty() && correction_s_ > 0 && !endsGuess(online.head);
  const auto then = goes_on ? earlier.camera(cameras_.back().head.frame) : std::nullopt;
  const SE3 now = online.T_world_cam;
  if (then)
    online.T_world_cam = continued(cameras_.back(), *then, now, now, online.head.stamp, kCameraShare * correction_s_);
  cameras_.push_back({online.head, online.T_world_cam});
  if (cameras_.size() > kCameras) cameras_.pop_front();
}

void ContinuousPoses::widenCamera(CameraCovariances& covariances, const SE3& estimated, const EarlierPoses& earlier,
                                  std::optional<FrameId> motion_begin) const {
  const SE3& published = cameras_.back().T_world;
  widen(covariances.pose, published, estimated);
  const Published* const begin = motion_begin ? cameraIn(*motion_begin) : nullptr;
  const auto estimated_begin = begin ? earlier.camera(begin->head.frame) : std::nullopt;
  if (estimated_begin)
    widen(covariances.motion, begin->T_world.inverse() * published, estimated_begin->inverse() * estimated);
}

const ContinuousPoses::Published* ContinuousPoses::cameraIn(FrameId frame) const {
  const auto found = std::ranges::find(cameras_, frame, [](const Published& camera) { return camera.head.frame; });
  return found != cameras_.end() ? &*found : nullptr;
}

/// The published pose, moved on from `then` to `now`, and a share of the way to `target`.
SE3 ContinuousPoses::continued(const Published& last, const SE3& then, const SE3& now, const SE3& target,
                               Timestamp stamp, double correction_s) const {
  const SE3 predicted = now * then.inverse() * last.T_world;
  const double share = 1 - exponential(-secondsBetween(last.head.stamp, stamp) / correction_s);
  const Vector6d correction = (predicted.inverse() * target).log();
  return (predicted * SE3::exp(share * correction)).normalized();
}

}  // namespace motorcade
