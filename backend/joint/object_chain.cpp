#include "backend/joint/object_chain.hpp"

#include <iterator>

#include "backend/factors/pose_factors.hpp"
#include "backend/factors/twist_factors.hpp"

namespace motorcade {
namespace {

constexpr double kFreeMotion = 1e6;  // times the accelerations' variance: nothing is known of how objects move

}  // namespace

void ObjectChain::begin(ObjectTrack& track, ObjectRecord& record) {
  const SE3& T_cam_body = record.seen.T_cam_body;
  record.pose = solver_.addVariable(T_cam_body);
  Vector6d twist = Vector6d::Zero();
  twist.head<3>() = T_cam_body.rotation().transpose() * record.seen.velocity_cam_mps;
  record.twist = solver_.addVariable(SmallVector(twist));
  track.has_gauge = false;
  solver_.addFactor(std::make_unique<VectorPriorFactor>(
      record.twist, twist,
      poseSigmas(params_.twist_sigma_mps, params_.tilt_rate_sigma_radps, params_.yaw_rate_sigma_radps)));
  track.shared = solver_.addVariable(SmallVector(SmallVector::Zero(3)));
  solver_.addFactor(std::make_unique<VectorPriorFactor>(
      track.shared, SmallVector::Zero(3),
      Eigen::Vector3d(params_.lever_sigma_m, params_.travel_yaw_sigma_rad, params_.travel_pitch_sigma_rad)));
  addRolling(track, record);
}

void ObjectChain::hold(ObjectTrack& track) {
  auto held = track.records.rbegin();
  for (auto earlier = std::next(held); earlier != track.records.rend(); held = earlier++)
    if (earlier->second.measured == 0 || !earlier->second.pose.valid()) break;
  solver_.addFactor(priorFactor(
      held->second.pose, held->second.seen.T_cam_body,
      poseSigmas(params_.object_origin_sigma_m, params_.object_axes_sigma_rad, params_.object_axes_sigma_rad)));
  track.has_gauge = true;
}

void ObjectChain::extend(const ObjectTrack& track, const ObjectRecord& before, ObjectRecord& record) {
  const double dt_s = secondsBetween(before.stamp, record.stamp);
  const SmallVector twist = std::get<SmallVector>(solver_.estimate(before.twist));
  const Vector6d step = dt_s * twist;
  const SE3 u = cameraMotion(before, record);
  const SE3 predicted = u.inverse() * solver_.pose(before.pose) * SE3::exp(step);
  record.pose = solver_.addVariable(track.has_gauge ? predicted.normalized() : record.seen.T_cam_body);
  record.twist = solver_.addVariable(twist);
  addMotion(track, before, record);
  addRolling(track, record);
}

SE3 ObjectChain::cameraMotion(const ObjectRecord& before, const ObjectRecord& now) const {
  return solver_.pose(frames_.at(before.seen.frame).x).inverse() * solver_.pose(frames_.at(now.seen.frame).x);
}

/// Adds the motion factors between two poses of an object. The camera's motion enters as known: points at rest tell it
/// a thousand times as well as an object of unknown acceleration could. So objects remain independent of each other.
void ObjectChain::addMotion(const ObjectTrack& track, const ObjectRecord& before, ObjectRecord& now) {
  ConstantTwistFactor::Variables variables{
      .c_a = before.pose, .w_a = before.twist, .c_b = now.pose, .w_b = now.twist, .x_a = {}, .x_b = {}};
  const CameraRecord &camera_before = frames_.at(before.seen.frame), &camera = frames_.at(now.seen.frame);
  if (camera_before.weak || camera.weak) variables.x_a = camera_before.x, variables.x_b = camera.x;
  const Vector6d density = (use_smoothness_ ? 1.0 : kFreeMotion) * params_.acceleration.density();
  now.motion = solver_.addFactor(std::make_unique<ConstantTwistFactor>(
      variables, cameraMotion(before, now), secondsBetween(before.stamp, now.stamp), density, travelAxes(track)));
}

void ObjectChain::addRolling(const ObjectTrack& track, const ObjectRecord& record) {
  if (use_smoothness_) solver_.addFactor(std::make_unique<RollingFactor>(record.twist, track.shared, params_.rolling));
}

void ObjectChain::renewMotion(ObjectTrack& track, FrameId newest) {
  const auto now = track.records.find(FrameId{newest.value - params_.track_frames});
  if (now == track.records.end() || now == track.records.begin() || !now->second.motion) return;
  const ObjectRecord& before = std::prev(now)->second;
  if (!before.pose.valid() || !now->second.pose.valid() || !frames_.contains(before.seen.frame)) return;
  solver_.removeFactor(*now->second.motion);
  addMotion(track, before, now->second);
}

Eigen::Matrix3d ObjectChain::travelAxes(const ObjectTrack& track) const {
  return motorcade::travelAxes(std::get<SmallVector>(solver_.estimate(track.shared)));
}

}  // namespace motorcade
