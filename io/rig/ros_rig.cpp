#include <string>

#include "io/rig/rig_parts.hpp"
#include "io/rig/rig_readers.hpp"

namespace motorcade {
namespace {

// Each in the spellings that are in use.
std::optional<YamlPart> rosProjection(const YamlPart& root) { return root.find({"projection_matrix", "P", "p"}); }
std::optional<YamlPart> rosIntrinsics(const YamlPart& root) { return root.find({"camera_matrix", "K", "k"}); }
YamlPart rosRotation(const YamlPart& root) { return root.at({"rectification_matrix", "R", "r"}); }

LensCamera rosCamera(const YamlPart& root) {
  LensCamera camera;
  setIntrinsics(camera, root.at({"camera_matrix", "K", "k"}));
  const YamlPart coefficients = root.at({"distortion_coefficients", "D", "d"});
  if (const std::string model = textOr(root, {"distortion_model"}, ""); !model.empty())
    setDistortion(camera, model, coefficients);
  else
    setDistortion(camera, coefficients);
  const auto width = root.find({"image_width", "width"}), height = root.find({"image_height", "height"});
  if (width && height) camera.size = {imageSide(*width, width->number()), imageSide(*height, height->number())};
  return camera;
}

/// Builds a rig from two parts with a projection. Each image is rectified by its own R into the left P, whose principal
/// point may differ from that of the right P.
Rig rosRigOf(const YamlPart& left, const YamlPart& right) {
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

}  // namespace

std::optional<Rig> rosRig(RigParts files) {
  const YamlPart& first = files.front();
  const auto left = first.find({"left"}), right = first.find({"right"});
  if (left && right && rosProjection(*left) && rosProjection(*right)) return rosRigOf(*left, *right);
  if (files.size() == 2 && rosProjection(first) && rosProjection(files.back())) return rosRigOf(first, files.back());
  if (rosProjection(first) && (files.size() == 1 || rosIntrinsics(files.back())))
    throw OneCameraError(first.file().string() +
                         ": is the calibration of one camera; give those of both, as left.yaml,right.yaml");
  if (rosIntrinsics(first) && first.find({"distortion_coefficients", "D", "d", "dist_coeffs", "dist_coeff"}))
    throw OneCameraError(first.file().string() +
                         ": is the calibration of one camera, without projection_matrix; what tells how both stand is "
                         "missing: give a file with M1 D1 M2 D2 R T (T in meters, from the left camera to the right)");
  return std::nullopt;
}

}  // namespace motorcade
