#include "apps/interface/camera_model.hpp"

#include <cmath>
#include <string>

#include "io/errors.hpp"
#include "io/image_limits.hpp"
#include "io/rig/rectification.hpp"

namespace motorcade {
namespace {

constexpr int kLeastSide_px = 64, kMostSide_px = 16384;

void require(bool holds, const std::string& field, const std::string& message) {
  if (!holds) throw Error(field, message);
}

std::string text(double value) {
  std::string digits = std::to_string(value);
  return digits.substr(0, digits.find_last_not_of('0') + (digits.back() == '0' ? 2 : 1));
}

void requireSize(const Camera& camera) {
  const std::string range = "is " + std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) +
                            "; images have 64 to 16384 pixels each way, and 2^26 in all";
  const auto fits = [](int side) { return side >= kLeastSide_px && side <= kMostSide_px; };
  require(fits(camera.width_px), "camera.width_px", range);
  require(fits(camera.height_px) && camera.width_px <= kMaxImage_pixels / camera.height_px, "camera.height_px", range);
}

/// Of one lens, or of the rectified pair.
template <class Intrinsics>
void requireIntrinsics(const std::string& name, const Intrinsics& lens, const Camera& camera) {
  const auto focal = [&](const char* key, double value_px) {
    require(std::isfinite(value_px) && value_px > 0, name + key,
            "is " + text(value_px) + "; a focal length is positive, in pixels");
  };
  const auto inside = [&](const char* key, double value_px, int side_px) {
    require(value_px > 0 && value_px < side_px, name + key,
            "is " + text(value_px) + "; the principal point lies within the image");
  };
  focal(".fx_px", lens.fx_px);
  focal(".fy_px", lens.fy_px);
  inside(".cx_px", lens.cx_px, camera.width_px);
  inside(".cy_px", lens.cy_px, camera.height_px);
}

LensCamera lensOf(const std::string& name, const Camera::Lens& lens, const Camera& camera) {
  requireIntrinsics(name, lens, camera);
  for (const double coefficient : lens.coefficients)
    require(std::isfinite(coefficient), name + ".coefficients", "are not all numbers");
  Distortion distortion = Distortion::kNone;
  if (lens.distortion == Camera::Distortion::kRadialTangential) distortion = Distortion::kRadialTangential;
  if (lens.distortion == Camera::Distortion::kEquidistant) distortion = Distortion::kEquidistant;
  return {.fx_px = lens.fx_px,
          .fy_px = lens.fy_px,
          .cx_px = lens.cx_px,
          .cy_px = lens.cy_px,
          .distortion = distortion,
          .coefficients = lens.coefficients,
          .size = {camera.width_px, camera.height_px}};
}

SE3 transformOf(const std::array<double, 12>& rows) {
  constexpr double kRoundedDigits = 1e-3;
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> T(rows.data());
  const Eigen::Matrix3d R = T.leftCols<3>();
  require(
      T.allFinite() && (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < kRoundedDigits && R.determinant() > 0,
      "camera.rig.T_right_left", "has no rotation in its first three columns; rows are r00 r01 r02 tx, ...");
  return SE3(R, T.col(3)).normalized();
}

Rectification rectificationOf(const Camera& camera, const Camera::Rig& rig) {
  const Rig raw{.file = "camera.rig",
                .left = lensOf("camera.rig.left", rig.left, camera),
                .right = lensOf("camera.rig.right", rig.right, camera),
                .T_right_left = transformOf(rig.T_right_left)};
  try {
    return rectificationOf(raw, ImageSize{camera.width_px, camera.height_px});
  } catch (const InputError& error) {
    throw Error("camera.rig", error.what());
  }
}

StereoCamera checked(const StereoCamera& camera) {
  constexpr double kMostBaseline_m = 10;
  require(camera.baseline_m > 0 && camera.baseline_m < kMostBaseline_m, "camera.baseline_m",
          "is " + text(camera.baseline_m) +
              "; the right camera lies to the right of the left one, by so many meters, less than ten");
  return camera;
}

}  // namespace

CameraModel::CameraModel(const Camera& camera) {
  requireSize(camera);
  if (!camera.rig) {
    requireIntrinsics("camera", camera, camera);
    rectified_ = checked(
        {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, camera.baseline_m, camera.width_px, camera.height_px});
    return;
  }
  const Rectification rectification = rectificationOf(camera, *camera.rig);
  const ImageSize size{camera.width_px, camera.height_px};
  rectified_ = checked(rectification.camera);
  remaps_.emplace(Remaps{.left = Remap(rectification.left, rectification.R_left, rectified_, size),
                         .right = Remap(rectification.right, rectification.R_right, rectified_, size)});
}

Camera cameraOf(const StereoCamera& camera) {
  return {.width_px = camera.width_px,
          .height_px = camera.height_px,
          .fx_px = camera.fx_px,
          .fy_px = camera.fy_px,
          .cx_px = camera.cx_px,
          .cy_px = camera.cy_px,
          .baseline_m = camera.baseline_m};
}

}  // namespace motorcade
