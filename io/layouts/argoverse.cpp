#include <array>
#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/se3.hpp"
#include "io/files/errors.hpp"
#include "io/files/json_text.hpp"
#include "io/files/text_file.hpp"
#include "io/layouts/layout_parts.hpp"

/// Argoverse 1: a log of its stereo set, or one of its tracking set that holds the rectified images.
namespace motorcade {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char *kLeft = "stereo_front_left_rect", *kRight = "stereo_front_right_rect";

/// A camera and its pose on the vehicle.
struct PlacedCamera {
  StereoCamera camera;
  SE3 T_vehicle_cam;
};

PlacedCamera placedCamera(const Json& value) {
  const Json& place = value.at("vehicle_SE3_camera_");
  const auto q = place.at("rotation").at("coefficients").get<std::array<double, 4>>();  // w x y z
  const auto t = place.at("translation").get<std::array<double, 3>>();
  return {.camera = {.fx_px = value.at("focal_length_x_px_").get<double>(),
                     .fy_px = value.at("focal_length_y_px_").get<double>(),
                     .cx_px = value.at("focal_center_x_px_").get<double>(),
                     .cy_px = value.at("focal_center_y_px_").get<double>()},
          .T_vehicle_cam = SE3(Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(),
                               Eigen::Vector3d(t[0], t[1], t[2]))};
}

PlacedCamera cameraNamed(const Json& calibration, const std::string& name) {
  for (const Json& entry : calibration.at("camera_data_"))
    if (entry.at("key") == "image_raw_" + name) return placedCamera(entry.at("value"));
  throw std::out_of_range("camera_data_ has no image_raw_" + name);
}

StereoCamera readCamera(const fs::path& file) try {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  constexpr double kLevel = 0.02;  // of the baseline, or radians: what is left of these between rectified cameras
  const Json json = parsedJson(readWhole(file, kMostBytes));
  const PlacedCamera left = cameraNamed(json, kLeft), right = cameraNamed(json, kRight);
  const SE3 T_left_right = left.T_vehicle_cam.inverse() * right.T_vehicle_cam;
  StereoCamera camera = left.camera;
  camera.baseline_m = T_left_right.translation().x();
  if (!(camera.fx_px >= 1) || !(camera.fy_px >= 1) || !(camera.baseline_m > 0) ||
      T_left_right.translation().tail<2>().norm() > kLevel * camera.baseline_m ||
      logSO3(T_left_right.rotation()).norm() > kLevel)
    throw InputError(file.string() + ": " + kLeft + " and " + kRight + " are not the cameras of a rectified pair");
  return camera;
} catch (const std::exception& error) {
  if (dynamic_cast<const UserError*>(&error) != nullptr) throw;
  throw InputError(file.string() + ": is no calibration of Argoverse's rectified pair: " + error.what());
}

}  // namespace

std::optional<Sequence> openArgoverse(const SequenceSource& source) {
  const fs::path left = source.path / kLeft, right = source.path / kRight;
  if (!fs::is_directory(left) || !fs::is_directory(right)) return std::nullopt;
  Sequence sequence{.folder = source.path, .layout = "argoverse", .pair = CameraPair::kColor};
  setKeyedFrames(sequence, {NameKind::kTimes, imagesByNumber(left), imagesByNumber(right)});
  setCamera(sequence, source.given, [&](ImageSize) {
    const fs::path of_pair = source.path / "vehicle_calibration_stereo_info.json";
    const fs::path file = fs::exists(of_pair) ? of_pair
                                              : neededFile(source.path / "vehicle_calibration_info.json",
                                                           "a log needs its calibration, or give --camera");
    sequence.calibrated_by = file.string();
    return readCamera(file);
  });
  return sequence;
}

}  // namespace motorcade
