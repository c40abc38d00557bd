#include "frontend/motion/camera_odometry.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

/// Beyond it no motion is likely to go on: the camera is taken to have stopped somewhere.
constexpr double kMaxPrediction_s = 1.0;

/// Where nothing else was measured for so long, a camera that seems to slide does so.
constexpr double kMaxUnbelieved_s = 5.0;

/// Over more steps than these, pitch and roll do not go on: a car nods and sways about where it is.
constexpr double kSteadySteps = 1.5;

/// Forward and turning, as a car drives on.
SE3 levelMotion(const SE3& motion) {
  const Vector6d twist = motion.log();
  Vector6d level = Vector6d::Zero();
  level[2] = twist[2], level[4] = twist[4];
  return SE3::exp(level);
}

/// Of a point: beyond it there is hardly a digit left in its covariance.
constexpr double kFarthest_m = 1e5;

/// A motion measured by fewer is as good as it can be, but not safe.
constexpr int kFewInliers = 25;

CameraMotion unlinked(const PredictedMotion& predicted, std::size_t observations) {
  return {.status = FrameStatus::kLost,
          .cause = FrameCause::kUnlinked,
          .T_seen_now = predicted.T_seen_now,
          .covariance = unknownMotionCovariance(predicted.dt_s),
          .inliers = std::vector<bool>(observations, false)};
}

}  // namespace

double CameraOdometry::sinceSeen_s(Timestamp stamp) const {
  return trail_.empty() ? 0 : secondsBetween(trail_.newest().stamp, stamp);
}

PredictedMotion CameraOdometry::predict(Timestamp stamp) const {
  const double dt_s = sinceSeen_s(stamp);
  const bool is_car = secondsBetween(measured_at_, stamp) < kMaxUnbelieved_s;
  PredictedMotion predicted{SE3{}, dt_s, steady_frames_, is_car ? ahead_frames_ : 0};
  if (!last_motion_ || last_dt_s_ <= 0) return predicted;
  const double predicted_s = secondsBetween(measured_at_, stamp);  // of which dt_s are the last
  const double steps = std::clamp(kMaxPrediction_s - (predicted_s - dt_s), 0.0, dt_s) / last_dt_s_;
  if (steps == 0) predicted.steady_frames = 0;  // the motion that was steady is over: it may stand or go on
  predicted.T_seen_now = scaledMotion(steps < kSteadySteps ? *last_motion_ : levelMotion(*last_motion_), steps);
  return predicted;
}

bool CameraOdometry::motionKnown(Timestamp stamp) const {
  return last_motion_ && secondsBetween(measured_at_, stamp) < kMaxPrediction_s;
}

Odometry CameraOdometry::add(Timestamp stamp, const CameraMotion& motion) {
  if (!trail_.empty() && motion.status == FrameStatus::kGood) {
    const PredictedMotion predicted = predict(stamp);
    steady_frames_ =
        last_motion_ && ego_motion_.follows(motion.T_seen_now.inverse(), predicted) ? steady_frames_ + 1 : 0;
    if (drivesAhead(motion.T_seen_now, predicted.dt_s)) ++ahead_frames_;
    if (slides(motion.T_seen_now, predicted.dt_s)) ahead_frames_ = 0;
    last_motion_ = motion.T_seen_now;
    last_dt_s_ = predicted.dt_s;
    measured_at_ = stamp;
  }
  if (motion.status != FrameStatus::kGood)
    unlinked_ = true;
  else if (std::exchange(unlinked_, false))
    ++segment_;
  trail_.add(stamp, motion.T_seen_now);
  last_stamp_ = stamp;
  return {std::exchange(T_seen_before_, SE3{}).inverse() * motion.T_seen_now, motion.covariance};
}

Odometry CameraOdometry::passOver(Timestamp stamp) {
  const SE3 T_seen_now = predict(stamp).T_seen_now;
  const SE3 T_seen_before = std::exchange(T_seen_before_, T_seen_now);
  const Timestamp before = std::exchange(last_stamp_, stamp).value_or(stamp);
  return {(T_seen_before.inverse() * T_seen_now).normalized(), unknownMotionCovariance(secondsBetween(before, stamp))};
}

CameraMotion CameraOdometry::measure(const StereoFrame& frame, const std::vector<std::optional<KnownPoint>>& known,
                                     const std::vector<std::optional<StereoObservation>>& observed,
                                     const PredictedMotion& predicted) const {
  assert(known.size() == observed.size());
  CameraMotion motion{.T_seen_now = SE3{}, .inliers = std::vector<bool>(observed.size(), false)};
  if (trail_.empty()) return motion;
  std::vector<PoseObservation> observations;
  std::vector<PointLabel> labels;
  std::vector<std::size_t> of_observation;
  observations.reserve(observed.size());
  of_observation.reserve(observed.size());
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (!known[i] || !observed[i] || known[i]->p_cam.z() > kFarthest_m) continue;
    observations.push_back({known[i]->p_cam, known[i]->covariance, observed[i]->uvd_px.cast<double>(),
                            observed[i]->sigma_px.cast<double>()});
    labels.push_back(known[i]->label);
    of_observation.push_back(i);
  }
  const auto ego = ego_motion_(observations, labels, predicted, static_cast<std::uint64_t>(frame.head.frame.value));
  if (!ego) return unlinked(predicted, observed.size());
  motion.T_seen_now = ego->T_seen_now;
  motion.covariance = ego->covariance;
  motion.inlier_count = ego->inlier_count;
  if (ego->inlier_count < kFewInliers) motion.cause = FrameCause::kFewPoints;
  motion.measured_count = static_cast<int>(observations.size());
  for (std::size_t k = 0; k < of_observation.size(); ++k) motion.inliers[of_observation[k]] = ego->inliers[k];
  return motion;
}

}  // namespace motorcade
