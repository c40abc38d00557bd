#include "frontend/motion/camera_odometry.hpp"

#include <cassert>
#include <cstddef>
#include <cstdint>

#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

CameraMotion predictedMotion(const SE3& T_previous_now, std::size_t observations) {
  CameraMotion motion{.status = FrameStatus::kLost,
                      .T_previous_now = T_previous_now,
                      .inliers = std::vector<bool>(observations, false)};
  motion.covariance = unknownMotionCovariance();
  return motion;
}

}  // namespace

SE3 CameraOdometry::predict(Timestamp stamp) const {
  if (!last_motion_ || last_dt_s_ <= 0) return SE3{};
  return scaledMotion(*last_motion_, secondsBetween(trail_.newest().stamp, stamp) / last_dt_s_);
}

CameraMotion CameraOdometry::operator()(const StereoFrame& frame, const std::vector<std::optional<KnownPoint>>& known,
                                        const std::vector<std::optional<StereoObservation>>& observed) {
  assert(known.size() == observed.size());
  CameraMotion motion;
  if (trail_.empty()) {
    motion.inliers.resize(observed.size(), false);
  } else {
    motion = measure(frame, known, observed);
    last_motion_ = motion.T_previous_now;
    last_dt_s_ = secondsBetween(trail_.newest().stamp, frame.stamp);
  }
  trail_.add(frame.stamp, motion.T_previous_now);
  return motion;
}

CameraMotion CameraOdometry::measure(const StereoFrame& frame, const std::vector<std::optional<KnownPoint>>& known,
                                     const std::vector<std::optional<StereoObservation>>& observed) {
  std::vector<PoseObservation> observations;
  std::vector<bool> known_movers;
  std::vector<std::size_t> of_observation;
  observations.reserve(observed.size());
  of_observation.reserve(observed.size());
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (!known[i] || !observed[i]) continue;
    observations.push_back({known[i]->p_cam, known[i]->covariance, observed[i]->uvd_px.cast<double>(),
                            observed[i]->sigma_px.cast<double>()});
    known_movers.push_back(known[i]->moving);
    of_observation.push_back(i);
  }
  const PredictedMotion predicted{predict(frame.stamp), secondsBetween(trail_.newest().stamp, frame.stamp),
                                  steady_frames_};
  const auto ego = ego_motion_(observations, known_movers, predicted, static_cast<std::uint64_t>(frame.frame.value));
  if (!ego) return predictedMotion(predicted.T_previous_now, observed.size());
  if (motionKnown()) steady_frames_ = ego->steady ? steady_frames_ + 1 : 0;
  CameraMotion motion{.T_previous_now = ego->T_previous_now,
                      .covariance = ego->covariance,
                      .inlier_count = ego->inlier_count,
                      .inliers = std::vector<bool>(observed.size(), false)};
  for (std::size_t k = 0; k < of_observation.size(); ++k) motion.inliers[of_observation[k]] = ego->inliers[k];
  return motion;
}

}  // namespace motorcade
