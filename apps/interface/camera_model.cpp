#include "apps/interface/camera_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <Eigen/LU>

#include "io/files/errors.hpp"
#include "io/images/image_limits.hpp"
#include "io/rig/rectification.hpp"

namespace motorcade {
namespace {

constexpr const char* kTransform = "camera.rig.T_right_left";
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

PixelMask ignoredOf(const Camera& camera) {
  const Camera::Ignored& given = camera.ignored;
  const int width = camera.width_px, height = camera.height_px;
  const auto requireBand = [](const char* field, int pixels, int all) {
    require(pixels >= 0 && pixels < all, field,
            "is " + std::to_string(pixels) + "; some of the image's " + std::to_string(all) + " must be left");
  };
  requireBand("camera.ignored.left_px", given.left_px, width);
  requireBand("camera.ignored.top_px", given.top_px, height);
  requireBand("camera.ignored.right_px", given.right_px, width);
  requireBand("camera.ignored.bottom_px", given.bottom_px, height);
  PixelMask ignored(width, height);
  require(given.mask.empty() || given.mask.size() == static_cast<std::size_t>(width) * height, "camera.ignored.mask",
          "has " + std::to_string(given.mask.size()) + " bytes; it has one for each pixel of the image, or none");
  ignored.add(0, 0, given.left_px, height);
  ignored.add(0, 0, width, given.top_px);
  ignored.add(width - given.right_px, 0, width, height);
  ignored.add(0, height - given.bottom_px, width, height);
  for (std::size_t i = 0; i < given.mask.size(); ++i) {
    const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
    if (given.mask[i] != 0) ignored.add(x, y, x + 1, y + 1);
  }
  return ignored;
}

/// Checks the intrinsics of one lens or of the rectified pair.
template <class Intrinsics>
void requireIntrinsics(const std::string& name, const Intrinsics& lens, const Camera& camera) {
  constexpr double kMostFocal_px = 1e6;
  const auto focal = [&](const char* key, double value_px) {
    require(value_px >= 1 && value_px <= kMostFocal_px, name + key,
            "is " + text(value_px) + "; a focal length is in pixels, from 1 to a million");
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

/// The distortion model, and the number of its coefficients.
std::pair<Distortion, std::ptrdiff_t> distortionOf(const std::string& name, Camera::Distortion distortion) {
  switch (distortion) {
    case Camera::Distortion::kNone:
      return {Distortion::kNone, 0};
    case Camera::Distortion::kRadialTangential:
      return {Distortion::kRadialTangential, 8};
    case Camera::Distortion::kEquidistant:
      return {Distortion::kEquidistant, 4};
  }
  throw Error(name + ".distortion", "is none of those that there are");
}

LensCamera lensOf(const std::string& name, const Camera::Lens& lens, const Camera& camera) {
  constexpr double kMostCoefficient = 1e6;
  requireIntrinsics(name, lens, camera);
  for (const double coefficient : lens.coefficients)
    require(std::abs(coefficient) < kMostCoefficient, name + ".coefficients", "are not all numbers below a million");
  const auto [distortion, count] = distortionOf(name, lens.distortion);
  require(std::all_of(lens.coefficients.begin() + count, lens.coefficients.end(), [](double c) { return c == 0; }),
          name + ".coefficients",
          "has values beyond the " + std::to_string(count) + " of this distortion; the others are 0");
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
      kTransform, "has no rotation in its first three columns; rows are r00 r01 r02 tx, ...");
  return SE3(R, T.col(3)).normalized();
}

Rectification rectificationOf(const Camera& camera, const Camera::Rig& rig) {
  const Rig raw{.file = kTransform,
                .left = lensOf("camera.rig.left", rig.left, camera),
                .right = lensOf("camera.rig.right", rig.right, camera),
                .T_right_left = transformOf(rig.T_right_left)};
  try {
    return rectificationOf(raw, ImageSize{camera.width_px, camera.height_px});
  } catch (const InputError& error) {
    throw Error(kTransform, std::string(error.what()).substr(std::string(kTransform).size() + 2));  // named once
  }
}

StereoCamera checked(const StereoCamera& camera, const std::string& field) {
  constexpr double kLeastBaseline_m = 1e-3, kMostBaseline_m = 10;
  require(camera.baseline_m >= kLeastBaseline_m && camera.baseline_m <= kMostBaseline_m, field,
          "gives a baseline of " + text(camera.baseline_m) +
              " m; the right camera lies to the right of the left one, by a millimeter to ten meters");
  return camera;
}

}  // namespace

bool isImageSize(int width_px, int height_px) {
  const auto fits = [](int side) { return side >= kLeastSide_px && side <= kMostSide_px; };
  return fits(width_px) && fits(height_px) && width_px <= kMaxImage_pixels / height_px;
}

CameraModel::CameraModel(const Camera& camera) {
  requireSize(camera);
  inputs_.ignored = sharedMask(ignoredOf(camera));
  if (!camera.rig) {
    requireIntrinsics("camera", camera, camera);
    rectified_ = checked(
        {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, camera.baseline_m, camera.width_px, camera.height_px},
        "camera.baseline_m");
    return;
  }
  const Rectification rectification = rectificationOf(camera, *camera.rig);
  const ImageSize size{camera.width_px, camera.height_px};
  rectified_ = checked(rectification.camera, kTransform);
  remaps_.emplace(Remaps{.left = Remap(rectification.left, rectification.R_left, rectified_, size),
                         .right = Remap(rectification.right, rectification.R_right, rectified_, size)});
}

std::optional<CalibrationSigmas> sigmasOf(const Camera& camera) {
  if (!camera.sigmas) return std::nullopt;
  const CalibrationSigmas sigmas{.focal = camera.sigmas->focal,
                                 .middle_px = camera.sigmas->middle_px,
                                 .distortion = camera.sigmas->distortion,
                                 .baseline = camera.sigmas->baseline,
                                 .disparity_px = camera.sigmas->disparity_px};
  for (const ParameterProblem& problem : problemsOf(sigmas))
    throw Error("camera.sigmas." + problem.name, "is " + problem.value + "; it is " + problem.allowed);
  return sigmas;
}

Camera cameraOf(const StereoCamera& camera, const std::optional<CalibrationSigmas>& sigmas) {
  Camera converted{.width_px = camera.width_px,
                   .height_px = camera.height_px,
                   .fx_px = camera.fx_px,
                   .fy_px = camera.fy_px,
                   .cx_px = camera.cx_px,
                   .cy_px = camera.cy_px,
                   .baseline_m = camera.baseline_m};
  if (sigmas)
    converted.sigmas = {.focal = sigmas->focal,
                        .middle_px = sigmas->middle_px,
                        .distortion = sigmas->distortion,
                        .baseline = sigmas->baseline,
                        .disparity_px = sigmas->disparity_px};
  return converted;
}

}  // namespace motorcade
