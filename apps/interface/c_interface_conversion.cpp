#include "apps/interface/c_interface_conversion.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "apps/interface/c_interface_structs.hpp"
#include "apps/interface/camera_model.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMostCpus = 1024;  // as many as sched_setaffinity counts

/// Converts an enum; both languages number the values alike. A caller's enum may hold any number, and so is read as
/// one.
template <class To, class From>
To valueOf(const From& given, To last, const char* field) {
  static_assert(sizeof(From) == sizeof(int));
  int value = 0;
  std::memcpy(&value, &given, sizeof value);
  if (value < 0 || value > static_cast<int>(last))
    throw Error(field, "is " + std::to_string(value) + "; its values are 0 to " +
                           std::to_string(static_cast<int>(last)) + " (motorcade.h)");
  return static_cast<To>(value);
}

static_assert(int{MOTORCADE_EQUIDISTANT} == static_cast<int>(Camera::Distortion::kEquidistant));
static_assert(int{MOTORCADE_BGR8} == static_cast<int>(Pair::Format::kBgr8));
static_assert(int{MOTORCADE_POLICY_REPLAY} == static_cast<int>(Tracker::Policy::kReplay));
static_assert(int{MOTORCADE_AXES_REP103} == static_cast<int>(Tracker::Axes::kRep103));
static_assert(int{MOTORCADE_LOG_ERROR} == static_cast<int>(Tracker::LogLevel::kError));

Camera::Lens lensOf(const motorcade_lens* given, const std::string& name) {
  const motorcade_lens lens = readStruct(given, name.c_str(), {});
  Camera::Lens converted{.fx_px = lens.fx_px, .fy_px = lens.fy_px, .cx_px = lens.cx_px, .cy_px = lens.cy_px};
  converted.distortion = valueOf(lens.distortion, Camera::Distortion::kEquidistant, (name + ".distortion").c_str());
  std::ranges::copy(lens.coefficients, converted.coefficients.begin());
  return converted;
}

Camera::Rig rigOf(const motorcade_rig* given) {
  const motorcade_rig rig = readStruct(given, "camera.rig", {});
  Camera::Rig converted{.left = lensOf(rig.left, "camera.rig.left"), .right = lensOf(rig.right, "camera.rig.right")};
  std::ranges::copy(rig.T_right_left, converted.T_right_left.begin());
  return converted;
}

/// Reads the ignored pixels. An impossible size is refused later: no mask of that size is read.
Camera::Ignored ignoredOf(const motorcade_camera& camera) {
  Camera::Ignored ignored{.left_px = camera.ignored_left_px,
                          .top_px = camera.ignored_top_px,
                          .right_px = camera.ignored_right_px,
                          .bottom_px = camera.ignored_bottom_px};
  if (camera.ignored_mask == nullptr || !isImageSize(camera.width_px, camera.height_px)) return ignored;
  const auto pixels = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  ignored.mask.assign(camera.ignored_mask, camera.ignored_mask + pixels);
  return ignored;
}

/// Converts an image; the result has no pixels when none is given.
Pair::Image imageOf(const motorcade_image* given, const char* name, const char* format_name) {
  if (given == nullptr) return {};
  const motorcade_image image = readStruct(given, name, {});
  return {.pixels = image.pixels,
          .width_px = image.width_px,
          .height_px = image.height_px,
          .stride_bytes = image.stride_bytes,
          .format = valueOf(image.format, Pair::Format::kBgr8, format_name)};
}

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

Camera cameraOf(const motorcade_camera* given) {
  const motorcade_camera camera = readStruct(given, "camera", {});
  Camera converted{.width_px = camera.width_px,
                   .height_px = camera.height_px,
                   .fx_px = camera.fx_px,
                   .fy_px = camera.fy_px,
                   .cx_px = camera.cx_px,
                   .cy_px = camera.cy_px,
                   .baseline_m = camera.baseline_m};
  if (camera.rig != nullptr) converted.rig = rigOf(camera.rig);
  converted.ignored = ignoredOf(camera);
  if (camera.has_sigmas)
    converted.sigmas = {.focal = camera.sigma_focal,
                        .middle_px = camera.sigma_middle_px,
                        .distortion = camera.sigma_distortion,
                        .baseline = camera.sigma_baseline,
                        .disparity_px = camera.sigma_disparity_px};
  return converted;
}

motorcade_options defaultOptions() {
  const Tracker::Options defaults;
  motorcade_options options{};
  options.policy = static_cast<motorcade_policy>(defaults.policy);
  options.axes = static_cast<motorcade_axes>(defaults.axes);
  options.masks = defaults.masks;
  options.threads = defaults.threads;
  options.realtime_priority = defaults.realtime_priority;
  options.patience_ms = defaults.patience.count();
  options.covariance_frames = defaults.covariance_frames;
  return options;
}

Tracker::Options optionsOf(const motorcade_options* given) {
  const motorcade_options options = readStruct(given, "options", defaultOptions());
  if (options.cpu_count > kMostCpus)
    throw Error("options.cpu_count", "is " + std::to_string(options.cpu_count) + "; it is at most 1024");
  if (options.cpu_count > 0) require(options.cpus, "options.cpus");
  const bool fits = options.covariance_frames == static_cast<int>(options.covariance_frames);
  if (!fits) throw Error("options.covariance_frames", "is " + std::to_string(options.covariance_frames));
  if (options.patience_ms < 0) throw Error("options.patience_ms", "is negative");
  Tracker::Options converted{.policy = valueOf(options.policy, Tracker::Policy::kReplay, "options.policy"),
                             .axes = valueOf(options.axes, Tracker::Axes::kRep103, "options.axes"),
                             .masks = options.masks,
                             .threads = options.threads,
                             .realtime_priority = options.realtime_priority,
                             .cpus = {options.cpus, options.cpus + options.cpu_count},
                             .patience = std::chrono::milliseconds(options.patience_ms),
                             .covariance_frames = static_cast<int>(options.covariance_frames),
                             .settings = options.settings != nullptr ? options.settings : ""};
  if (options.log != nullptr)
    converted.log = [log = options.log, user = options.log_user](Tracker::LogLevel level, const std::string& text) {
      log(static_cast<motorcade_log_level>(level), text.c_str(), user);
    };
  return converted;
}

motorcade_pair defaultPair() {
  motorcade_pair pair{};
  pair.frame = Pair{}.frame;
  return pair;
}

Pair pairOf(const motorcade_pair* given) {
  const motorcade_pair pair = readStruct(given, "pair", defaultPair());
  return {.left = imageOf(pair.left, "pair.left", "pair.left.format"),
          .right = imageOf(pair.right, "pair.right", "pair.right.format"),
          .stamp_ns = pair.stamp_ns,
          .frame = pair.frame,
          .instances = imageOf(pair.instances, "pair.instances", "pair.instances.format")};
}

VehicleMotion motionOf(const motorcade_vehicle_motion* given) {
  const motorcade_vehicle_motion motion = readStruct(given, "motion", motorcade_vehicle_motion{});
  return {.stamp_ns = motion.stamp_ns,
          .speed_mps = motion.speed_mps,
          .yaw_rate_radps = motion.yaw_rate_radps,
          .speed_sigma_mps = motion.speed_sigma_mps,
          .yaw_rate_sigma_radps = motion.yaw_rate_sigma_radps};
}

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
