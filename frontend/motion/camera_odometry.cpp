#include "frontend/motion/camera_odometry.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <Eigen/Eigenvalues>

#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

/// Longest time over which a motion goes on: beyond it the camera is taken to have stopped somewhere.
constexpr double kMaxPrediction_s = 1.0;

/// Time without any other measurement after which a camera that seems to slide does so.
constexpr double kMaxUnbelieved_s = 5.0;

/// Steps beyond which pitch and roll do not go on: a car nods and sways about where it is.
constexpr double kSteadySteps = 1.5;

/// Common part of two numbers: the one nearer to zero, or zero if their signs differ.
double commonPart(double a, double b) { return a * b <= 0 ? 0 : std::abs(a) < std::abs(b) ? a : b; }

/// Distance of a point beyond which there is hardly a digit left in its covariance.
constexpr double kFarthest_m = 1e5;

/// Points below which a measured motion is as good as it can be, but not safe.
constexpr int kFewInliers = 25;

/// Speed below which a camera stands; its noise is a tenth of it.
constexpr double kStanding_mps = 0.2;
constexpr int kStandingFrames = 5;  // in a row, after which it is believed

// A motion that the vehicle's sensors contradict is believed when so many points agree on it, and such a share.
constexpr int kSureInliers = 60;
constexpr double kSureShare = 0.6;

/// True when the view moves as vehicles around the camera would make it. They go along with it, so that it seems to
/// stand, or move off while it stands, so that it seems to go back or aside.
bool mayBeVehicles(const SE3& seen, const SE3& told, double dt_s) {
  constexpr double kSlow_mps = 0.5, kMoving_mps = 2, kAlongShare = 0.15, kAlong_mps = 1.5;
  const double seen_m = seen.translation().norm(), told_m = told.translation().norm();
  const bool goes_along = told_m > kMoving_mps * dt_s && seen_m < std::min(kAlongShare * told_m, kAlong_mps * dt_s);
  const bool moves_off = told_m < kSlow_mps * dt_s && seen.translation().z() < 0.5 * seen_m;
  return goes_along || moves_off;
}

CameraMotion unlinked(const PredictedMotion& predicted, std::size_t observations, bool is_disputed) {
  return {.status = FrameStatus::kLost,
          .cause = FrameCause::kUnlinked,
          .T_seen_now = predicted.T_seen_now,
          .covariance = predicted.by_vehicle.value_or(unknownMotionCovariance(predicted.dt_s)),
          .disputed = is_disputed,
          .inliers = std::vector<bool>(observations, false)};
}

/// Growth of the variance of a way, or an angle, from one moment to another after it was measured, by an unknown
/// constant acceleration.
double accelerated2(double sigma_per_s2, double then_s, double now_s) {
  const auto sigma = [&](double t_s) { return 0.5 * sigma_per_s2 * t_s * t_s; };
  return sigma(now_s) * sigma(now_s) - sigma(then_s) * sigma(then_s);
}

/// Positive part of a difference of covariances, which is that of a step but for rounding and what frames share.
Matrix6d positivePart(const Matrix6d& difference) {
  constexpr double kLeast = 1e-8;  // of a tenth of a millimeter, or a hundredth of a degree
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(0.5 * (difference + difference.transpose()));
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(kLeast).asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

double CameraOdometry::sinceSeen_s(Timestamp stamp) const {
  return trail_.empty() ? 0 : secondsBetween(trail_.newest().stamp, stamp);
}

PredictedMotion CameraOdometry::predict(Timestamp stamp) const {
  PredictedMotion predicted = predictedByCamera(stamp);
  if (const Told told = vehicle_.motion(toldSince(stamp), stamp)) {
    predicted.T_seen_now = told->T_then_now;
    predicted.by_vehicle = told->covariance;
  }
  return predicted;
}

PredictedMotion CameraOdometry::predictedByCamera(Timestamp stamp) const {
  const double dt_s = sinceSeen_s(stamp);
  const bool is_car = secondsBetween(measured_at_, stamp) < kMaxUnbelieved_s;
  PredictedMotion predicted{.T_seen_now = SE3{},
                            .dt_s = dt_s,
                            .steady_frames = steady_frames_,
                            .ahead_frames = is_car ? ahead_frames_ : 0,
                            .R_cam_level = R_cam_level_,
                            .stood = standing_frames_ >= kStandingFrames && standing(stamp)};
  if (!last_motion_ || last_dt_s_ <= 0) return predicted;
  const double predicted_s = secondsBetween(measured_at_, stamp);  // of which dt_s are the last
  const double steps = std::clamp(kMaxPrediction_s - (predicted_s - dt_s), 0.0, dt_s) / last_dt_s_;
  if (steps == 0) predicted.steady_frames = 0;  // the motion that was steady is over: it may stand or go on
  predicted.T_seen_now = scaledMotion(steps < kSteadySteps ? *last_motion_ : levelMotion(), steps);
  return predicted;
}

/// The last motion as a car drives on: ahead, and in yaw as far as it turned in both of the last steps. A jolt is over.
SE3 CameraOdometry::levelMotion() const {
  Vector6d level = Vector6d::Zero();
  level[2] = inAxes(R_cam_level_, *last_motion_).log()[2];
  level[4] = last_dt_s_ * turn_radps_;
  return inAxes(R_cam_level_.transpose(), SE3::exp(level));
}

/// A motion of a car with these variances of its way ahead and its yaw, about which it shakes.
UncertainMotion CameraOdometry::drivenOn(const SE3& motion, double ahead_m2, double yaw_rad2) const {
  constexpr double kShake_m = 0.01, kShake_rad = 0.002;
  Vector6d variances;  // in level axes
  variances << Eigen::Vector3d::Constant(kShake_m * kShake_m), Eigen::Vector3d::Constant(kShake_rad * kShake_rad);
  variances[2] += ahead_m2;
  variances[4] += yaw_rad2;
  const Matrix6d turn = SE3(R_cam_level_, Eigen::Vector3d::Zero()).adjoint();
  return {motion, turn * variances.asDiagonal() * turn.transpose()};
}

/// Motion ahead and in yaw that the prediction leaves out, as a twist: the camera may have stopped, or have gone on.
/// The covariances of the steps add up to its square.
Vector6d CameraOdometry::withheld(Timestamp stamp) const {
  constexpr double kLongest_s = 60;  // nobody asks for more
  if (!last_motion_ || last_dt_s_ <= 0) return Vector6d::Zero();
  const double withheld_s = std::clamp(secondsBetween(measured_at_, stamp) - kMaxPrediction_s, 0.0, kLongest_s);
  return withheld_s / last_dt_s_ * levelMotion().log();
}

/// The motion since the last frame that was seen, if the camera stood when it was measured last. Vehicles that
/// fill the view may hide that it has started since. The variance of the way ahead grows as if it had.
CameraOdometry::Told CameraOdometry::standing(Timestamp stamp) const {
  constexpr double kLongest_s = 3;  // in which an ordinary start leads 7 m ahead: then nothing is known
  constexpr double kStart_mps2 = 1.5, kCurvature_1pm = 0.2;  // of an ordinary start, and of the sharpest turn
  const double now_s = secondsBetween(stood_until_, stamp), then_s = secondsBetween(stood_until_, toldSince(stamp));
  if (now_s > kLongest_s) return std::nullopt;
  const double ahead_m2 = accelerated2(kStart_mps2, then_s, now_s);
  return drivenOn(SE3{}, ahead_m2, kCurvature_1pm * kCurvature_1pm * ahead_m2);
}

/// The motion since the last frame that was seen, if a steady one was measured just before.
CameraOdometry::Told CameraOdometry::steady(Timestamp stamp) const {
  constexpr int kLeastFrames = 3;
  constexpr double kLongest_s = 0.5;
  constexpr double kBrake_mps2 = 4, kSwing_radps2 = 0.5;  // of a car that brakes, and that begins to turn
  const double now_s = secondsBetween(measured_at_, stamp), then_s = secondsBetween(measured_at_, toldSince(stamp));
  if (steady_frames_ < kLeastFrames || now_s > kLongest_s) return std::nullopt;
  return drivenOn(predictedByCamera(stamp).T_seen_now, accelerated2(kBrake_mps2, then_s, now_s),
                  accelerated2(kSwing_radps2, then_s, now_s));
}

/// Time of the last frame that was seen, or of the first one of all.
Timestamp CameraOdometry::toldSince(Timestamp stamp) const {
  return trail_.empty() ? first_stamp_.value_or(stamp) : trail_.newest().stamp;
}

bool CameraOdometry::motionKnown(Timestamp stamp) const {
  if (vehicle_.motion(toldSince(stamp), stamp)) return true;
  return last_motion_ && secondsBetween(measured_at_, stamp) < kMaxPrediction_s;
}

Odometry CameraOdometry::add(Timestamp stamp, const CameraMotion& motion) {
  const bool is_good = motion.status == FrameStatus::kGood;
  const bool is_first = trail_.empty();
  Told told = is_good ? vehicle_.motion(toldSince(stamp), stamp) : vehicle_.motionUnseen(toldSince(stamp), stamp);
  if (!told && !is_good) told = standing_frames_ >= kStandingFrames ? standing(stamp) : steady(stamp);
  if (!is_first && is_good) rememberMotion(stamp, motion);
  if (motion.disputed) vehicle_.dispute();
  if (!is_good)
    unlinked_ = unlinked_ || !told;
  else if (std::exchange(unlinked_, false))
    ++segment_;
  Odometry odometry = stepTo(stamp, is_first && told ? told->T_then_now : motion.T_seen_now, motion.covariance, told);
  if (told && (is_first || !is_good)) odometry.covariance = odometry.told->covariance;
  T_seen_before_ = SE3{};
  told_before_.reset();
  trail_.add(stamp, motion.T_seen_now);
  vehicle_.forgetBefore(stamp);
  return odometry;
}

void CameraOdometry::rememberMotion(Timestamp stamp, const CameraMotion& motion) {
  const PredictedMotion predicted = predict(stamp);
  steady_frames_ = last_motion_ && ego_motion_.follows(motion.T_seen_now.inverse(), predicted) ? steady_frames_ + 1 : 0;
  const SE3 over_road = inAxes(R_cam_level_, motion.T_seen_now);
  if (drivesAhead(over_road, predicted.dt_s)) ++ahead_frames_;
  if (slides(over_road, predicted.dt_s)) ahead_frames_ = 0;
  const double yaw_rate_radps = predicted.dt_s > 0 ? over_road.log()[4] / predicted.dt_s : 0;
  turn_radps_ = last_motion_ ? commonPart(yaw_rate_radps, yaw_rate_radps_) : yaw_rate_radps;
  yaw_rate_radps_ = yaw_rate_radps;
  last_motion_ = motion.T_seen_now;
  last_dt_s_ = predicted.dt_s;
  measured_at_ = stamp;
  const bool stands = motion.T_seen_now.translation().norm() < kStanding_mps * predicted.dt_s;
  if (stands || motion.cause == FrameCause::kNone) {  // a few points on a vehicle do not start the camera
    standing_frames_ = stands ? standing_frames_ + 1 : 0;
    stood_until_ = stamp;
  }
  if (motion.cause == FrameCause::kNone)
    vehicle_.compare(trail_.newest().stamp, stamp, {motion.T_seen_now, motion.covariance});
}

Odometry CameraOdometry::passOver(Timestamp stamp) {
  const Timestamp before = last_stamp_.value_or(stamp);
  const Told told = vehicle_.motionUnseen(toldSince(stamp), stamp);
  SE3 T_seen_now = told ? told->T_then_now : predictedByCamera(stamp).T_seen_now;
  if (!told && told_before_) {  // the sensors fall silent: on from where they led
    const SE3 T_seen_before = predictedByCamera(before).T_seen_now;
    T_seen_now = T_seen_before_ * T_seen_before.inverse() * T_seen_now;
  }
  const Vector6d withheld_before = withheld(before), withheld_now = withheld(stamp);
  const Matrix6d covariance = unknownMotionCovariance(secondsBetween(before, stamp)) +
                              withheld_now * withheld_now.transpose() - withheld_before * withheld_before.transpose();
  Odometry odometry = stepTo(stamp, T_seen_now, covariance, told);
  odometry.T_previous_now = odometry.T_previous_now.normalized();
  if (told) odometry.covariance = odometry.told->covariance;
  T_seen_before_ = T_seen_now;
  if (told) told_before_ = told;
  return odometry;
}

/// Step from the frame before, seen or not. What is told of it is what is told since the last frame that was seen, from
/// where the frame before was taken to be. What was told up to that frame is subtracted from the covariance.
Odometry CameraOdometry::stepTo(Timestamp stamp, const SE3& T_seen_now, const Matrix6d& covariance, const Told& told) {
  last_stamp_ = stamp;
  if (!first_stamp_) first_stamp_ = stamp;
  Odometry odometry{T_seen_before_.inverse() * T_seen_now, covariance};
  if (!told) return odometry;
  const SE3 T_before_now = T_seen_before_.inverse() * told->T_then_now;
  odometry.told = {T_before_now.normalized(), told->covariance};
  if (!told_before_) return odometry;
  const Matrix6d A = T_before_now.inverse().adjoint();
  odometry.told->covariance = positivePart(told->covariance - A * told_before_->covariance * A.transpose());
  return odometry;
}

/// Measures a motion that contradicts the vehicle's sensors. They may be wrong, but not because a few points move
/// alike: most must.
std::optional<EgoMotion> CameraOdometry::againstVehicle(std::span<const PoseObservation> observations,
                                                        const std::vector<PointLabel>& labels,
                                                        const FrameHead& head) const {
  auto ego =
      ego_motion_(observations, labels, predictedByCamera(head.stamp), static_cast<std::uint64_t>(head.frame.value));
  if (!ego || ego->inlier_count < kSureInliers ||
      ego->inlier_count < kSureShare * static_cast<double>(observations.size()))
    return std::nullopt;
  return ego;
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
  const auto seed = static_cast<std::uint64_t>(frame.head.frame.value);
  auto ego = ego_motion_(observations, labels, predicted, seed);
  bool is_disputed = false;
  if (!ego && predicted.by_vehicle) {
    ego = againstVehicle(observations, labels, frame.head);
    is_disputed = ego && mayBeVehicles(ego->T_seen_now, predicted.T_seen_now, predicted.dt_s);
  }
  if (!ego || is_disputed) return unlinked(predicted, observed.size(), is_disputed);
  motion.T_seen_now = ego->T_seen_now;
  motion.covariance = ego->covariance;
  motion.inlier_count = ego->inlier_count;
  if (ego->inlier_count < kFewInliers) motion.cause = FrameCause::kFewPoints;
  motion.measured_count = static_cast<int>(observations.size());
  for (std::size_t k = 0; k < of_observation.size(); ++k) motion.inliers[of_observation[k]] = ego->inliers[k];
  return motion;
}

}  // namespace motorcade
