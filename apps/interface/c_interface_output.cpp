#include "apps/interface/c_interface_output.hpp"

#include <algorithm>
#include <limits>

namespace motorcade {
namespace {

static_assert(int{MOTORCADE_STATUS_REJECTED} == static_cast<int>(Result::Status::kRejected));
static_assert(int{MOTORCADE_CAUSE_TOO_LATE} == static_cast<int>(Result::Cause::kTooLate));
static_assert(int{MOTORCADE_STATE_PREDICTED} == static_cast<int>(Result::State::kPredicted));
static_assert(int{MOTORCADE_KIND_PEDESTRIAN} == static_cast<int>(Result::Kind::kPedestrian));
static_assert(int{MOTORCADE_PUSH_REJECTED} == static_cast<int>(Tracker::Push::Status::kRejected));

template <std::size_t kCount>
void copy(const std::array<double, kCount>& from, double (&to)[kCount]) {
  std::ranges::copy(from, to);
}

}  // namespace

motorcade_frame frameOf(const Result& result) {
  motorcade_frame frame{};
  frame.frame = result.frame;
  frame.stamp_ns = result.stamp_ns;
  frame.status = static_cast<motorcade_status>(result.status);
  frame.cause = static_cast<motorcade_cause>(result.cause);
  frame.segment = result.segment;
  frame.dropped_before = result.dropped_before;
  copy(result.T_world_cam, frame.T_world_cam);
  frame.has_motion_covariance = result.motion_covariance.has_value();
  if (result.motion_covariance) copy(*result.motion_covariance, frame.motion_covariance);
  copy(result.velocity, frame.velocity);
  copy(result.velocity_covariance, frame.velocity_covariance);
  frame.object_count = result.objects.size();
  frame.latency_ms = result.latency_ms;
  frame.problem = result.problem.c_str();
  frame.has_pose_covariance = result.pose_covariance.has_value();
  if (result.pose_covariance) copy(*result.pose_covariance, frame.pose_covariance);
  return frame;
}

void setAcceleration(const std::optional<Result::Acceleration>& acceleration, motorcade_object& object) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto known = acceleration.value_or(Result::Acceleration{kUnknown, kUnknown, kUnknown, kUnknown});
  object.acceleration_mps2 = known.along_mps2;
  object.acceleration_sigma_mps2 = known.along_sigma_mps2;
  object.yaw_acceleration_radps2 = known.yaw_radps2;
  object.yaw_acceleration_sigma_radps2 = known.yaw_sigma_radps2;
}

motorcade_object objectOf(const Result::Object& object) {
  motorcade_object converted{};
  converted.id = object.id;
  converted.state = static_cast<motorcade_state>(object.state);
  converted.points = object.points;
  copy(object.T_world_body, converted.T_world_body);
  copy(object.T_cam_body, converted.T_cam_body);
  converted.has_covariance = object.covariance.has_value();
  if (object.covariance) copy(*object.covariance, converted.covariance);
  copy(object.velocity_world_mps, converted.velocity_world_mps);
  copy(object.velocity_covariance, converted.velocity_covariance);
  converted.yaw_rate_radps = object.yaw_rate_radps;
  converted.yaw_rate_sigma_radps = object.yaw_rate_sigma_radps;
  converted.age_s = object.age_s;
  copy(object.image_box_px, converted.image_box_px);
  copy(object.box_center_body_m, converted.box_center_body_m);
  copy(object.box_size_m, converted.box_size_m);
  copy(object.box_size_sigma_m, converted.box_size_sigma_m);
  copy(object.box_center_sigma_m, converted.box_center_sigma_m);
  converted.kind = static_cast<motorcade_kind>(object.kind);
  converted.kind_probability = object.kind_probability;
  converted.existence_probability = object.existence_probability;
  setAcceleration(object.acceleration, converted);
  return converted;
}

motorcade_mask maskOf(const Result::Mask& mask) {
  motorcade_mask converted{};
  converted.left_px = mask.left_px;
  converted.top_px = mask.top_px;
  converted.cell_px = mask.cell_px;
  converted.width_cells = mask.width_cells;
  converted.height_cells = mask.height_cells;
  converted.inside = mask.inside.data();
  return converted;
}

motorcade_push pushOf(const Tracker::Push& push) {
  return {.struct_size = 0, .status = static_cast<motorcade_push_status>(push.status), .why = push.why};
}

motorcade_counts countsOf(const Tracker::Counts& counts) {
  return {.struct_size = 0,
          .pushed = counts.pushed,
          .rejected = counts.rejected,
          .dropped = counts.dropped,
          .results = counts.results,
          .untaken = counts.untaken};
}

/// The camera of a recording has no rig, and ignores nothing.
motorcade_camera cCameraOf(const Camera& camera) {
  motorcade_camera converted{};
  converted.width_px = camera.width_px;
  converted.height_px = camera.height_px;
  converted.fx_px = camera.fx_px;
  converted.fy_px = camera.fy_px;
  converted.cx_px = camera.cx_px;
  converted.cy_px = camera.cy_px;
  converted.baseline_m = camera.baseline_m;
  converted.has_sigmas = camera.sigmas.has_value();
  const Camera::Sigmas sigmas = camera.sigmas.value_or(Camera::Sigmas{});
  converted.sigma_focal = sigmas.focal;
  converted.sigma_middle_px = sigmas.middle_px;
  converted.sigma_distortion = sigmas.distortion;
  converted.sigma_baseline = sigmas.baseline;
  converted.sigma_disparity_px = sigmas.disparity_px;
  return converted;
}

motorcade_image cImageOf(const Pair::Image& image) {
  return {.struct_size = sizeof(motorcade_image),
          .pixels = image.pixels,
          .width_px = image.width_px,
          .height_px = image.height_px,
          .format = static_cast<motorcade_format>(image.format),
          .stride_bytes = image.stride_bytes};
}

}  // namespace motorcade
