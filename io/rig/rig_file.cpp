#include "io/rig/rig_file.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "io/errors.hpp"
#include "io/rig/rig_parts.hpp"
#include "io/rig/yaml_file.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

// Each in the spellings that are in use.
std::optional<YamlPart> rosProjection(const YamlPart& root) { return root.find({"projection_matrix", "P", "p"}); }
YamlPart rosRotation(const YamlPart& root) { return root.at({"rectification_matrix", "R", "r"}); }
std::optional<YamlPart> openCvLeft(const YamlPart& root) { return root.find({"M1", "cameraMatrix1", "K1"}); }

std::string textOr(const YamlPart& part, std::string_view key, const std::string& otherwise) {
  const auto found = part.find({key});
  return found ? found->text() : otherwise;
}

LensCamera kalibrCamera(const YamlPart& part) {
  LensCamera camera;
  if (const std::string model = textOr(part, "camera_model", "pinhole"); model != "pinhole")
    part.at({"camera_model"})
        .fail("is " + printable(model) + ", only pinhole is understood; calibrate anew with pinhole-radtan " +
              "or pinhole-equi");
  setIntrinsics(camera, part.at({"intrinsics"}));
  setDistortion(camera, textOr(part, "distortion_model", "none"),
                part.at({"distortion_coeffs", "distortion_coefficients"}));
  if (const auto size = part.find({"resolution"})) setSize(camera, *size);
  return camera;
}

Rig kalibrRig(const YamlPart& root) {
  const YamlPart right = root.at({"cam1"});
  return {.file = root.file(),
          .left = kalibrCamera(root.at({"cam0"})),
          .right = kalibrCamera(right),
          .T_right_left = transform44(right.at({"T_cn_cnm1"}))};
}

LensCamera rosCamera(const YamlPart& root) {
  LensCamera camera;
  setIntrinsics(camera, root.at({"camera_matrix", "K", "k"}));
  setDistortion(camera, textOr(root, "distortion_model", "plumb_bob"), root.at({"distortion_coefficients", "D", "d"}));
  const auto width = root.find({"image_width", "width"}), height = root.find({"image_height", "height"});
  if (width && height)
    camera.size = {imageSide(*width, width->numbers(1)[0]), imageSide(*height, height->numbers(1)[0])};
  return camera;
}

/// Of two files with a projection. The pair is rectified by both R, into the left P: it may differ from the right one
/// in where its middle lies.
Rig rosRig(const YamlPart& left, const YamlPart& right) {
  const YamlPart left_part = *rosProjection(left), right_part = *rosProjection(right);
  const auto P_left = left_part.numbers(12), P_right = right_part.numbers(12);
  Rig rig{.file = left.file(), .left = rosCamera(left), .right = rosCamera(right)};
  constexpr double kLeast_px = 1;
  if (!(P_left[0] >= kLeast_px) || !(P_left[5] >= kLeast_px)) left_part.fail("must have positive focal lengths");
  const StereoCamera camera{.fx_px = P_left[0],
                            .fy_px = P_left[5],
                            .cx_px = P_left[2],
                            .cy_px = P_left[6],
                            .baseline_m = P_left[3] / P_left[0] - P_right[3] / P_left[0]};
  if (!(camera.baseline_m > 0))
    right_part.fail("gives a baseline of " + std::to_string(camera.baseline_m) +
                    " m, -P[3] / P[0] must be positive: calibrate both cameras together, and give the left file first");
  rig.given = Rectification{.left = rig.left,
                            .right = rig.right,
                            .R_left = rotation33(rosRotation(left)),
                            .R_right = rotation33(rosRotation(right)),
                            .camera = camera};
  return rig;
}

/// From one file that holds both, or from two; the first has the left camera's matrix.
Rig openCvRig(const YamlPart& intrinsics, const YamlPart& extrinsics) {
  Rig rig{.file = intrinsics.file()};
  setIntrinsics(rig.left, *openCvLeft(intrinsics));
  setIntrinsics(rig.right, intrinsics.at({"M2", "cameraMatrix2", "K2"}));
  const std::string model = textOr(intrinsics, "distortion_model", "radtan");
  setDistortion(rig.left, model, intrinsics.at({"D1", "distCoeffs1"}));
  setDistortion(rig.right, model, intrinsics.at({"D2", "distCoeffs2"}));
  const YamlPart translation = extrinsics.at({"T", "t"});
  const auto t = translation.numbers(3);
  rig.T_right_left = SE3(rotation33(extrinsics.at({"R"})), Eigen::Vector3d(t[0], t[1], t[2]));
  constexpr double kFar_m = 10;
  if (rig.T_right_left.translation().norm() > kFar_m)
    translation.fail("puts the cameras " + std::to_string(rig.T_right_left.translation().norm()) +
                     " m apart; it must be in meters, as large as the squares of the board were told to be");
  return rig;
}

[[noreturn]] void failUnknown(const fs::path& file) {
  throw InputError(file.string() +
                   ": is no calibration of a pair that is understood; give Kalibr's camchain (cam0, cam1), OpenCV's "
                   "M1 D1 M2 D2 R T (or intrinsics.yml,extrinsics.yml), or ROS' camera_info as left.yaml,right.yaml");
}

SE3 eurocPlacement(const YamlPart& sensor) { return transform44(sensor.at({"T_BS"})); }

LensCamera eurocCamera(const YamlPart& sensor) {
  LensCamera camera;
  if (const std::string model = textOr(sensor, "camera_model", "pinhole"); model != "pinhole")
    sensor.at({"camera_model"}).fail("is " + printable(model) + ", only pinhole is understood");
  setIntrinsics(camera, sensor.at({"intrinsics"}));
  setDistortion(camera, textOr(sensor, "distortion_model", "none"),
                sensor.at({"distortion_coefficients", "distortion_coeffs"}));
  if (const auto size = sensor.find({"resolution"})) setSize(camera, *size);
  return camera;
}

}  // namespace

Rig readRig(const std::vector<fs::path>& files) {
  if (files.empty() || files.size() > 2) throw UsageError("--calibration: one file, or two with a comma between them");
  const YamlPart first = YamlPart::ofFile(files.front()), second = YamlPart::ofFile(files.back());
  if (first.find({"cam0"})) return kalibrRig(first);
  if (openCvLeft(first)) return openCvRig(first, second);
  if (openCvLeft(second)) return openCvRig(second, first);
  if (rosProjection(first)) {
    if (files.size() == 2 && rosProjection(second)) return rosRig(first, second);
    throw InputError(files.front().string() +
                     ": is the calibration of one camera; give those of both, as left.yaml,right.yaml");
  }
  failUnknown(files.front());
}

Rig readEurocRig(const fs::path& left, const fs::path& right) {
  const YamlPart left_sensor = YamlPart::ofFile(left), right_sensor = YamlPart::ofFile(right);
  return {.file = left,
          .left = eurocCamera(left_sensor),
          .right = eurocCamera(right_sensor),
          .T_right_left = eurocPlacement(right_sensor).inverse() * eurocPlacement(left_sensor)};
}

SE3 readEurocPlacement(const fs::path& sensor_file) { return eurocPlacement(YamlPart::ofFile(sensor_file)); }

std::vector<fs::path> usualRigFiles(const fs::path& folder) {
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path extension = entry.path().extension();
    if ((extension == ".yaml" || extension == ".yml") && entry.is_regular_file()) files.insert(entry.path());
  }
  const auto named = [&](const std::string& stem) {
    return std::ranges::find_if(files, [&](const fs::path& file) { return file.stem() == stem; });
  };
  for (const auto& [first, second] : {std::pair("left", "right"), std::pair("intrinsics", "extrinsics")})
    if (named(first) != files.end() && named(second) != files.end()) return {*named(first), *named(second)};
  for (const fs::path& file : files)
    if (file.stem().string().find("camchain") != std::string::npos) return {file};
  for (const char* name : {"stereo", "calibration", "calib"})
    if (named(name) != files.end()) return {*named(name)};
  return {};
}

}  // namespace motorcade
