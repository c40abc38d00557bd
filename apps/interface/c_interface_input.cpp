#include "apps/interface/c_interface_input.hpp"

#include <algorithm>
#include <cstring>
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

}  // namespace motorcade
