#include <string>

#include "io/rig/rig_parts.hpp"
#include "io/rig/rig_readers.hpp"

namespace motorcade {
namespace {

/// The parts of a stereo calibration in the spellings that are in use; empty where a file does not have them.
std::optional<YamlPart> leftMatrix(const YamlPart& root) {
  return root.find({"M1", "cameraMatrix1", "K1", "camera_matrix_1", "camera_matrix1", "cameraMatrixL", "cameraMatrix_L",
                    "camera_matrix_left", "left_camera_matrix", "mtxL", "mtx_l", "mtx_left", "K_left", "Kl", "K_l",
                    "left.camera_matrix", "left.K"});
}
YamlPart rightMatrix(const YamlPart& root) {
  return root.at({"M2", "cameraMatrix2", "K2", "camera_matrix_2", "camera_matrix2", "cameraMatrixR", "cameraMatrix_R",
                  "camera_matrix_right", "right_camera_matrix", "mtxR", "mtx_r", "mtx_right", "K_right", "Kr", "K_r",
                  "right.camera_matrix", "right.K"});
}
YamlPart leftCoefficients(const YamlPart& root) {
  return root.at({"D1", "distCoeffs1", "dist_coeffs_1", "dist_coeffs1", "distCoeffsL", "distCoeffs_L",
                  "distortion_coefficients_left", "left_distortion_coefficients", "dist_coeffs_left", "distL", "dist_l",
                  "dist_left", "D_left", "Dl", "D_l", "left.distortion_coefficients", "left.D"});
}
YamlPart rightCoefficients(const YamlPart& root) {
  return root.at({"D2", "distCoeffs2", "dist_coeffs_2", "dist_coeffs2", "distCoeffsR", "distCoeffs_R",
                  "distortion_coefficients_right", "right_distortion_coefficients", "dist_coeffs_right", "distR",
                  "dist_r", "dist_right", "D_right", "Dr", "D_r", "right.distortion_coefficients", "right.D"});
}

void setLenses(Rig& rig, const YamlPart& intrinsics) {
  setIntrinsics(rig.left, *leftMatrix(intrinsics));
  setIntrinsics(rig.right, rightMatrix(intrinsics));
  const YamlPart left = leftCoefficients(intrinsics), right = rightCoefficients(intrinsics);
  if (const std::string model = textOr(intrinsics, {"distortion_model"}, ""); !model.empty()) {
    setDistortion(rig.left, model, left);
    setDistortion(rig.right, model, right);
  } else {
    setDistortion(rig.left, left);
    setDistortion(rig.right, right);
  }
  const auto width = intrinsics.find({"image_width", "width"}), height = intrinsics.find({"image_height", "height"});
  if (width && height) rig.left.size = {imageSide(*width, width->number()), imageSide(*height, height->number())};
}

/// Reads a rig from one file that holds both parts, or from two; `intrinsics` has the left camera's matrix.
Rig openCvRigOf(const YamlPart& intrinsics, const YamlPart& extrinsics) {
  Rig rig{.file = intrinsics.file(), .transform = "T"};
  setLenses(rig, intrinsics);
  const YamlPart translation = extrinsics.at({"T", "t", "translation", "translation_vector", "Trans", "trans"});
  const auto t = translation.numbers(3);
  rig.T_right_left = SE3(rotation33(extrinsics.at({"R", "rotation", "rotation_matrix", "Rot", "rot"})),
                         Eigen::Vector3d(t[0], t[1], t[2]));
  constexpr double kFar_m = 10;
  if (rig.T_right_left.translation().norm() > kFar_m)
    translation.fail("puts the cameras " + std::to_string(rig.T_right_left.translation().norm()) +
                     " m apart; it must be in meters, as large as the squares of the board were told to be");
  return rig;
}

}  // namespace

std::optional<Rig> openCvRig(RigParts files) {
  if (leftMatrix(files.front())) return openCvRigOf(files.front(), files.back());
  if (leftMatrix(files.back())) return openCvRigOf(files.back(), files.front());
  if (files.front().find({"R"}) && files.front().find({"T"}) && files.front().find({"R1", "P1", "E", "F"}))
    throw OneCameraError(
        files.front().file().string() +
        ": has R and T of both cameras, but not their lenses M1 D1 M2 D2; give "
        "intrinsics.yml,extrinsics.yml, or --camera fx,fy,cx,cy,baseline for images that are rectified");
  return std::nullopt;
}

}  // namespace motorcade
