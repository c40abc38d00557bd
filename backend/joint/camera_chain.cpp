#include "backend/joint/camera_chain.hpp"

#include "backend/factors/pose_factors.hpp"
#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

constexpr int kFewStatic = 20;  // landmarks seen now and before: with fewer the front-end's odometry helps

/// Longest time before the first points over which a motion is predicted back: for longer, the camera may have stood.
constexpr double kMaxPrediction_s = 1.0;

}  // namespace

bool showsPoints(const FrameHead& head) {
  return head.status == FrameStatus::kGood || head.cause == FrameCause::kUnlinked;
}

CameraRecord CameraChain::add(const FrameMeasurements& m, int seen_again) {
  const SE3 T_previous_now = isFinite(m.odometry.T_previous_now) ? m.odometry.T_previous_now : SE3{};
  CameraRecord camera{.head = m.head, .x = {}, .part = 0, .weak = false, .covariances = {}};
  if (frames_.empty()) {
    camera.x = solver_.addVariable(SE3{});
    start_.gauge = addGaugePrior(camera.x, SE3{});
  } else {
    const VariableId before = frames_.rbegin()->second.x;
    camera.x = solver_.addVariable((solver_.pose(before) * T_previous_now).normalized());
    last_seen_.T_seen_now = (last_seen_.T_seen_now * T_previous_now).normalized();
    camera.weak = m.head.status != FrameStatus::kGood || seen_again < kFewStatic;
    link(m, camera);
  }
  if (!showsPoints(m.head)) return camera;
  last_seen_ = {m.head.frame, SE3{}};
  unseen_.clear();
  return camera;
}

/// Links a camera pose that points hardly tell: by odometry since points were last seen, and by what is told without
/// images since the previous frame. Where nothing is told, unseen frames lie on a steady motion as soon as it is
/// measured where it led. An unknown motion begins a new part: behind a weak factor the rest of the path would float.
void CameraChain::link(const FrameMeasurements& m, CameraRecord& camera) {
  const auto& [frame_before, before] = *frames_.rbegin();
  camera.part = before.part;
  if (!last_seen_.frame.valid()) return linkUnseen(m, camera);
  const bool after_unseen = last_seen_.frame != frame_before;
  const bool told = m.odometry.told && (camera.weak || after_unseen);
  if (told) addOdometry(m.odometry.told->T_previous_now, m.odometry.told->covariance, before.x, camera.x);
  if (m.head.cause == FrameCause::kUnlinked) {
    if (told) return;
    ++camera.part;
    addGaugePrior(camera.x, solver_.pose(camera.x));
    return;
  }
  const auto seen = frames_.find(last_seen_.frame);
  if (!showsPoints(m.head) || seen == frames_.end()) {
    const Matrix6d covariance = showsPoints(m.head) ? unknownMotionCovariance() : m.odometry.covariance;
    if (told) return;
    const auto factor = addOdometry(m.odometry.T_previous_now, covariance, before.x, camera.x);
    if (seen == frames_.end())
      unseen_.clear();  // a motion since then will not be measured any more
    else
      unseen_.push_back({factor, before.x, camera.x, before.head.stamp, m.head.stamp});
    return;
  }
  if (after_unseen && !told) unseen_.push_back({{}, before.x, camera.x, before.head.stamp, m.head.stamp});
  moveSteadily(m.head.stamp, seen->second.head.stamp);
  if (camera.weak) addOdometry(last_seen_.T_seen_now, m.odometry.covariance, seen->second.x, camera.x);
  if (m.head.status == FrameStatus::kGood) moveStart(m.head.stamp, seen->second.head.stamp);
}

/// Links a frame before any points were seen. The world is the first frame with points, so the gauge moves there.
void CameraChain::linkUnseen(const FrameMeasurements& m, const CameraRecord& camera) {
  const CameraRecord& before = frames_.rbegin()->second;
  if (const auto& told = m.odometry.told) {
    addOdometry(told->T_previous_now, told->covariance, before.x, camera.x);
  } else {
    const std::optional<FactorId> link =
        addOdometry(m.odometry.T_previous_now, m.odometry.covariance, before.x, camera.x);
    start_.steps.push_back({link, before.x, camera.x, before.head.stamp, m.head.stamp});
  }
  if (!showsPoints(m.head)) return;
  if (start_.gauge) solver_.removeFactor(*start_.gauge);
  addGaugePrior(camera.x, solver_.pose(camera.x));
}

/// Extends the first measured motion, up to `now`, back over the frames before anything was seen.
void CameraChain::moveStart(Timestamp now, Timestamp seen_first) {
  for (const PredictedStep& step : start_.steps)
    if (secondsBetween(step.from, seen_first) <= kMaxPrediction_s)
      replace(step, last_seen_.T_seen_now, secondsBetween(seen_first, now));
  start_ = {};
}

/// Spreads the motion that was measured over unseen frames evenly on them. The predictions knew less: they end in a
/// camera that stands.
void CameraChain::moveSteadily(Timestamp now, Timestamp seen_before) {
  for (const PredictedStep& step : unseen_) replace(step, last_seen_.T_seen_now, secondsBetween(seen_before, now));
}

void CameraChain::replace(const PredictedStep& step, const SE3& motion, double motion_s) {
  const double dt_s = secondsBetween(step.from, step.to);
  if (step.factor) solver_.removeFactor(*step.factor);
  addOdometry(scaledMotion(motion, dt_s / motion_s), unknownMotionCovariance(dt_s), step.before, step.now);
}

std::optional<FactorId> CameraChain::addGaugePrior(VariableId x, const SE3& mean) {
  return solver_.addFactor(priorFactor(
      x, mean, poseSigmas(params_.first_pose_sigma_m, params_.first_pose_sigma_rad, params_.first_pose_sigma_rad)));
}

std::optional<FactorId> CameraChain::addOdometry(const SE3& T_before_now, const Matrix6d& covariance, VariableId before,
                                                 VariableId now) {
  auto root = squareRootInformation(covariance);
  if (!root) root = squareRootInformation(unknownMotionCovariance());
  const PoseNoise noise{.sqrt_information = *root};
  return solver_.addFactor(std::make_unique<MotionFactor>(std::array{before, now}, MotionModel{T_before_now}, noise));
}

}  // namespace motorcade
