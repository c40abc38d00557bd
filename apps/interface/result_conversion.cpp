#include "apps/interface/result_conversion.hpp"

#include <algorithm>
#include <limits>
#include <new>

#include "apps/pipeline/log_callback.hpp"
#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

template <int kSize>
std::array<double, std::size_t{kSize} * kSize> rowsOf(const Eigen::Matrix<double, kSize, kSize>& matrix) {
  std::array<double, std::size_t{kSize} * kSize> rows{};
  Eigen::Map<Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(rows.data()) = matrix;
  return rows;
}

std::array<double, 12> rowsOf(const SE3& T) {
  std::array<double, 12> rows{};
  Eigen::Map<RowMajor34> matrix(rows.data());
  matrix << T.rotation(), T.translation();
  return rows;
}

std::array<double, 3> arrayOf(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Rotates a covariance: its perturbations (rho, phi) are then in the axes to which R leads.
Matrix6d turned(const Matrix6d& covariance, const Eigen::Matrix3d& R) {
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = R;
  return J * covariance * J.transpose();
}

Result::Status statusOf(FrameStatus status) {
  switch (status) {
    case FrameStatus::kGood:
      return Result::Status::kGood;
    case FrameStatus::kLost:
      return Result::Status::kLost;
    case FrameStatus::kRejected:
    case FrameStatus::kDropped:
      return Result::Status::kRejected;
  }
  return Result::Status::kRejected;
}

Result::State stateOf(ObjectState state) {
  switch (state) {
    case ObjectState::kMoving:
      return Result::State::kMoving;
    case ObjectState::kStopped:
      return Result::State::kStopped;
    case ObjectState::kPredicted:
      return Result::State::kPredicted;
  }
  return Result::State::kPredicted;
}

Result::Kind kindOf(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::kUnknown:
      return Result::Kind::kUnknown;
    case ObjectKind::kCar:
      return Result::Kind::kCar;
    case ObjectKind::kLargeVehicle:
      return Result::Kind::kLargeVehicle;
    case ObjectKind::kTwoWheeler:
      return Result::Kind::kTwoWheeler;
    case ObjectKind::kPedestrian:
      return Result::Kind::kPedestrian;
  }
  return Result::Kind::kUnknown;
}

Result::Cause causeOf(FrameCause cause) {
  static_assert(static_cast<int>(Result::Cause::kTooLate) == static_cast<int>(FrameCause::kTooLate));
  static_assert(static_cast<int>(Result::Cause::kTooLate) + 1 == kCauseCount);
  return static_cast<Result::Cause>(cause);
}

void setCuboid(const ObjectBox& cuboid, Result::Object& object) {
  object.box_center_body_m = arrayOf(cuboid.center_body);
  object.box_size_m = arrayOf(cuboid.size_m);
  object.box_size_sigma_m = arrayOf(cuboid.size_sigma_m);
  object.box_center_sigma_m = arrayOf(cuboid.center_sigma_m);
  object.kind = kindOf(cuboid.kind);
  object.kind_probability = cuboid.kind_probability;
}

void setMask(const std::vector<ObjectMask>& masks, TrackId track, Result::Object& object) {
  const auto mask = std::ranges::find(masks, track, &ObjectMask::track);
  if (mask == masks.end()) return;
  object.mask = Result::Mask{.left_px = mask->left_px,
                             .top_px = mask->top_px,
                             .cell_px = mask->cell_px,
                             .width_cells = mask->width,
                             .height_cells = mask->height,
                             .inside = mask->inside};
}

Eigen::Matrix3d axesFrom(Tracker::Axes axes) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (axes == Tracker::Axes::kRep103) R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

/// True unless the odometry passed over the frame. The next frame's motion does not start at a frame that was passed
/// over.
bool wasLookedAt(const FrameMeasurements& measured) {
  return measured.head.cause != FrameCause::kNothingFound && measured.head.cause != FrameCause::kUnusable;
}

}  // namespace

ResultConversion::ResultConversion(Tracker::Axes axes, bool masks) : R_out_cam_(axesFrom(axes)), masks_(masks) {}

Result ResultConversion::cameraOf(const FrameEstimate& estimate) const {
  const SE3 T_out_cam(R_out_cam_, Eigen::Vector3d::Zero());
  Result converted;
  converted.frame = estimate.head.frame.value;
  converted.stamp_ns = estimate.head.stamp.ns;
  converted.status = statusOf(estimate.head.status);
  converted.cause = causeOf(estimate.head.cause);
  converted.segment = estimate.head.segment;
  converted.T_world_cam = rowsOf(T_out_cam * estimate.T_world_cam * T_out_cam.inverse());
  const auto inOutputAxes = [this](const Matrix6d& covariance) { return rowsOf<6>(turned(covariance, R_out_cam_)); };
  const CameraCovariances& covariances = estimate.camera_covariances;
  if (covariances.motion) converted.motion_covariance = inOutputAxes(*covariances.motion);
  if (covariances.pose) converted.pose_covariance = inOutputAxes(*covariances.pose);
  return converted;
}

Result ResultConversion::operator()(const PipelineResult& result) {
  Result converted = cameraOf(result.online);
  if (result.measurements) setVelocity(*result.measurements, converted);
  const auto dropped =
      std::ranges::count(result.dropped, FrameStatus::kDropped, [](const FrameEstimate& f) { return f.head.status; }) +
      result.dropped_unnamed;
  converted.dropped_before = static_cast<int>(std::min<std::int64_t>(dropped, std::numeric_limits<int>::max()));
  converted.latency_ms = result.timing.latency_ms();
  try {
    setObjects(result, converted);
    converted.problem = result.problem;
  } catch (const std::bad_alloc&) {
    converted.objects.clear();
    converted.status = Result::Status::kLost;
    converted.cause = Result::Cause::kFailed;
    converted.problem = kNoMemoryLeft;
  }
  return converted;
}

Result ResultConversion::final(const FrameEstimate& estimate) {
  Result converted = cameraOf(estimate);
  converted.velocity_covariance =
      rowsOf<6>(turned(unknownMotionCovariance(std::numeric_limits<double>::infinity()), R_out_cam_));
  for (const ObjectEstimate& seen : estimate.objects) converted.objects.push_back(object(seen, estimate.T_world_cam));
  return converted;
}

void ResultConversion::setObjects(const PipelineResult& result, Result& converted) {
  converted.objects.reserve(result.online.objects.size());
  for (const ObjectEstimate& estimate : result.online.objects) {
    converted.objects.push_back(object(estimate, result.online.T_world_cam));
    if (masks_) setMask(result.masks, estimate.track, converted.objects.back());
  }
}

/// Sets the camera's velocity. A measured motion begins at the last frame that was looked at, a predicted one at the
/// previous frame. In the first frame the velocity is unknown.
void ResultConversion::setVelocity(const FrameMeasurements& measured, Result& converted) {
  const bool seen = wasLookedAt(measured);
  const std::optional<Timestamp> since = seen ? seen_ : before_;
  const double dt_s = since ? secondsBetween(*since, measured.head.stamp) : 0;
  T_seen_before_ = (T_seen_before_ * measured.odometry.T_previous_now).normalized();
  Matrix6d covariance = unknownMotionCovariance(std::numeric_limits<double>::infinity());  // per second
  if (dt_s > 0) {
    const Vector6d velocity = (seen ? T_seen_before_ : measured.odometry.T_previous_now).log() / dt_s;
    Eigen::Map<Eigen::Vector3d>(converted.velocity.data()) = R_out_cam_ * velocity.head<3>();
    Eigen::Map<Eigen::Vector3d>(converted.velocity.data() + 3) = R_out_cam_ * velocity.tail<3>();
    covariance = measured.odometry.covariance / (dt_s * dt_s);
  }
  converted.velocity_covariance = rowsOf<6>(turned(covariance, R_out_cam_));
  before_ = measured.head.stamp;
  if (!seen) return;
  seen_ = measured.head.stamp;
  T_seen_before_ = SE3{};
}

Result::Object ResultConversion::object(const ObjectEstimate& object, const SE3& T_world_cam) {
  const SE3 T_out_cam(R_out_cam_, Eigen::Vector3d::Zero());
  Result::Object converted;
  converted.id = first_id_ + object.track.value;
  next_id_ = std::max(next_id_, converted.id + 1);
  converted.state = stateOf(object.state);
  converted.T_world_body = rowsOf(T_out_cam * object.T_world_body);
  converted.T_cam_body = rowsOf(T_out_cam * T_world_cam.inverse() * object.T_world_body);
  if (object.covariance) converted.covariance = rowsOf<6>(*object.covariance);
  converted.velocity_world_mps = arrayOf(R_out_cam_ * object.velocity_world_mps);
  const Eigen::Matrix3d isotropic = Eigen::Matrix3d::Identity() * (object.speed_sigma_mps * object.speed_sigma_mps);
  const Eigen::Matrix3d velocity_covariance = object.velocity_covariance.value_or(isotropic);
  converted.velocity_covariance = rowsOf<3>(R_out_cam_ * velocity_covariance * R_out_cam_.transpose());
  converted.yaw_rate_radps = object.yaw_rate_radps;
  converted.yaw_rate_sigma_radps = object.yaw_rate_sigma_radps;
  converted.age_s = object.age_s;
  converted.existence_probability = object.existence_probability;
  converted.points = object.points;
  converted.image_box_px = {object.box.left_px, object.box.top_px, object.box.right_px, object.box.bottom_px};
  if (object.cuboid) setCuboid(*object.cuboid, converted);
  if (const auto& acceleration = object.acceleration)
    converted.acceleration = {.along_mps2 = acceleration->along_mps2,
                              .along_sigma_mps2 = acceleration->along_sigma_mps2,
                              .yaw_radps2 = acceleration->yaw_radps2,
                              .yaw_sigma_radps2 = acceleration->yaw_sigma_radps2};
  return converted;
}

}  // namespace motorcade
