#include "io/sequence/calibration.hpp"

#include <cmath>
#include <string>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/sequence/calibration_keys.hpp"

namespace motorcade {
namespace {

std::string placeOf(const std::filesystem::path& file, int line) {
  return file.string() + (line > 0 ? ", line " + std::to_string(line) : "");
}

Eigen::Matrix<double, 3, 4> matrix34(const CalibrationValues& v) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(v.numbers.data());
}
Eigen::Matrix3d squareMatrix(const CalibrationValues& v) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.numbers.data());
}
/// Builds a transform. Fails for zeros, a reflection, and any other matrix that is no rotation.
SE3 rigid(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m, const CalibrationValues& v,
          const CalibrationKeys& keys) {
  if (!isRotation(rotation)) keys.fail(v, "holds no rotation matrix");
  return SE3(rotation, translation_m).normalized();
}
SE3 rigid(const CalibrationValues& v, const CalibrationKeys& keys) {
  const auto m = matrix34(v);
  return rigid(m.leftCols<3>(), m.col(3), v, keys);
}

/// `R:` and `T:` of the raw layout's files between two sensors.
std::optional<SE3> readRotationTranslation(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  CalibrationKeys keys(file);
  const auto* R = keys.find({"R"}, 9);
  const auto* T = keys.find({"T"}, 3);
  if (!R || !T) throw InputError(file.string() + ": key R or T is missing");
  return rigid(squareMatrix(*R), Eigen::Map<const Eigen::Vector3d>(T->numbers.data()), *R, keys);
}

int imageSide_px(const CalibrationValues& values, std::size_t i, const CalibrationKeys& keys) {
  const double side_px = values.numbers[i];
  if (!(side_px >= 1 && side_px <= kMaxImage_pixels)) keys.fail(values, "is no size of an image");
  return static_cast<int>(side_px);
}

/// The matrices cam0 and cam1 of Middlebury's and ETH3D's pairs, whose baseline is in millimeters.
void addMiddlebury(Calibration& calibration, CalibrationKeys& keys) {
  if (calibration.P[0] || calibration.P[1] || !keys.has("baseline")) return;
  const auto* left = keys.find({"cam0"}, 9);
  const auto* right = keys.find({"cam1"}, 9);
  const auto* baseline_mm = keys.find({"baseline"}, 1);
  if (!left || !right) return;
  for (auto& P : {&calibration.P[0], &calibration.P[1]}) *P = Calibration::Projection::Zero();
  calibration.P[0]->leftCols<3>() = squareMatrix(*left);
  calibration.P[1]->leftCols<3>() = squareMatrix(*right);
  (*calibration.P[1])(0, 3) = -squareMatrix(*left)(0, 0) * 1e-3 * baseline_mm->numbers[0];
  calibration.line_of_P = {left->line, right->line, 0, 0};
  const auto *width = keys.find({"width"}, 1), *height = keys.find({"height"}, 1);
  if (width && height) calibration.size[0] = ImageSize{imageSide_px(*width, 0, keys), imageSide_px(*height, 0, keys)};
}

/// Reads standard deviations in the order of `parametersOf`.
CalibrationSigmas sigmasOf(const CalibrationValues& values, const CalibrationKeys& keys) {
  CalibrationSigmas sigmas;
  auto number = values.numbers.begin();
  for (const Parameter& sigma : parametersOf(sigmas)) {
    if (!sigma.accepts(*number))
      keys.fail(values, "has a wrong number " + std::to_string(number - values.numbers.begin() + 1) + ", of '" +
                            sigma.name + "': write " + sigma.allowed());
    *std::get<double*>(sigma.value) = *number++;
  }
  return sigmas;
}

void requireFocalLength(double focal_px, const std::string& name) {
  constexpr double kMost_px = 1e6;  // a pixel of a camera that sees one degree of a 16384 px wide image has 9e5
  if (!(focal_px > 0)) throw InputError(name + ": the focal lengths must be positive");
  if (focal_px < 1 || focal_px > kMost_px)
    throw InputError(name + ": a focal length is " + std::to_string(focal_px) +
                     " px; no camera has less than 1 px or more than 1e6");
}

/// Throws unless P belongs to a rectified camera without skew.
void requirePinhole(const Calibration::Projection& P, const std::string& name) {
  constexpr double kTolerance = 1e-6;
  const Eigen::Vector3d last_row(P(2, 0), P(2, 1), P(2, 2));
  const bool pinhole = (last_row - Eigen::Vector3d::UnitZ()).cwiseAbs().maxCoeff() < kTolerance &&
                       std::abs(P(0, 1)) < kTolerance * P(0, 0) && std::abs(P(1, 0)) < kTolerance * P(1, 1);
  if (!pinhole) throw InputError(name + ": its left 3x3 part must be fx 0 cx, 0 fy cy, 0 0 1");
}

std::size_t leftOf(CameraPair pair) { return pair == CameraPair::kGray ? 0 : 2; }

void requireProjections(const Calibration& calibration, std::size_t left) {
  const char *const first = left == 0 ? "P0" : "P2", *const second = left == 0 ? "P1" : "P3";
  const bool has_first = calibration.P[left].has_value(), has_second = calibration.P[left + 1].has_value();
  const std::string images =
      left == 0 ? "the images are those of cameras 0 and 1" : "the images are those of cameras 2 and 3";
  if (!has_first && !has_second)
    throw InputError(calibration.file.string() + ": has no " + first + " and " + second + "; " +
                     (calibration.advice.empty() ? images : calibration.advice));
  if (!has_first || !has_second)
    throw InputError(calibration.file.string() + ": key " + (has_first ? second : first) + " is missing; " + images);
}

/// Requires a rectified pair. The middles of its images may lie in different columns: the disparities then have an
/// offset.
void requireRectified(const Calibration::Projection& P_left, const Calibration::Projection& P_right,
                      const std::string& names) {
  const double tolerance_px = 1e-3 * P_left(0, 0), most_px = 0.25 * P_left(0, 0);
  Eigen::Matrix3d difference = (P_left.leftCols<3>() - P_right.leftCols<3>()).cwiseAbs();
  const double middles_px = difference(0, 2);
  difference(0, 2) = 0;
  if (difference.maxCoeff() > tolerance_px)
    throw InputError(names +
                     " differ in their left 3x3 part by more than cx: the pair is not rectified; give the calibration "
                     "of both lenses instead (Kalibr's camchain, OpenCV's M1 D1 M2 D2 R T)");
  if (!(middles_px < most_px))
    throw InputError(names + " differ by " + std::to_string(middles_px) +
                     " px in cx, more than rectified images do: is one of them of another image size?");
}

}  // namespace

double Calibration::rightMiddle_px(CameraPair pair) const {
  constexpr double kSame_px = 0.02;  // moves no disparity by what a match can tell
  const double left_px = (*P[leftOf(pair)])(0, 2), right_px = (*P[leftOf(pair) + 1])(0, 2);
  return std::abs(left_px - right_px) > kSame_px ? right_px : left_px;
}

std::optional<ImageSize> Calibration::rectifiedSize(CameraPair pair) const { return size[leftOf(pair)]; }

StereoCamera Calibration::stereoCamera(CameraPair pair) const {
  const std::size_t left = leftOf(pair);
  requireProjections(*this, left);
  const Projection &P_left = *P[left], &P_right = *P[left + 1];
  const std::string name = placeOf(file, line_of_P[left]) + ": key P" + std::to_string(left);
  requireFocalLength(P_left(0, 0), name);
  requireFocalLength(P_left(1, 1), name);
  requirePinhole(P_left, name);
  requireRectified(P_left, P_right, name + " and P" + std::to_string(left + 1));
  const StereoCamera camera{.fx_px = P_left(0, 0),
                            .fy_px = P_left(1, 1),
                            .cx_px = P_left(0, 2),
                            .cy_px = P_left(1, 2),
                            .baseline_m = (P_left(0, 3) - P_right(0, 3)) / P_left(0, 0)};
  if (!(camera.baseline_m > 0)) {
    throw InputError(name + ": the baseline (P_left[3] - P_right[3]) / fx is " + std::to_string(camera.baseline_m) +
                     " m, it must be positive: are left and right swapped?");
  }
  return camera;
}

SE3 Calibration::T_left_cam0(CameraPair pair) const {
  if (pair == CameraPair::kGray || !P[2]) return {};
  const Eigen::Vector3d p = P[2]->col(3);  // P2 = K * [I | t]
  const double t_z = p.z();
  return {Eigen::Matrix3d::Identity(),
          {(p.x() - (*P[2])(0, 2) * t_z) / (*P[2])(0, 0), (p.y() - (*P[2])(1, 2) * t_z) / (*P[2])(1, 1), t_z}};
}

std::optional<SE3> Calibration::T_cam0_imu() const {
  if (!R_rect || !T_cam_velo || !T_velo_imu) return std::nullopt;
  return SE3(*R_rect, Eigen::Vector3d::Zero()) * *T_cam_velo * *T_velo_imu;
}

Calibration readCalibration(const std::filesystem::path& file) {
  CalibrationKeys keys(file);
  Calibration calibration{.file = file};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i);
    if (const auto* v = keys.find({"P" + n, "P_rect_0" + n}, 12)) {
      calibration.P[i] = matrix34(*v);
      calibration.line_of_P[i] = v->line;
    }
    if (const auto* v = keys.find({"S_rect_0" + n}, 2))
      calibration.size[i] = ImageSize{imageSide_px(*v, 0, keys), imageSide_px(*v, 1, keys)};
  }
  addMiddlebury(calibration, keys);
  if (const auto* v = keys.find({"R0_rect", "R_rect", "R_rect_00"}, 9))
    calibration.R_rect = rigid(squareMatrix(*v), Eigen::Vector3d::Zero(), *v, keys).rotation();
  if (const auto* v = keys.find({"Tr_velo_to_cam", "Tr_velo_cam"}, 12)) calibration.T_cam_velo = rigid(*v, keys);
  if (const auto* v = keys.find({"Tr_imu_to_velo", "Tr_imu_velo"}, 12)) calibration.T_velo_imu = rigid(*v, keys);
  if (const auto* v = keys.find({"calibration_sigmas"}, kCalibrationSigmas)) calibration.sigmas = sigmasOf(*v, keys);
  const auto& P = calibration.P;
  if (!(P[0] && P[1]) && !(P[2] && P[3])) calibration.advice = keys.advice();
  return calibration;
}

Calibration readRawCalibration(const std::filesystem::path& date_folder) {
  Calibration calibration = readCalibration(date_folder / "calib_cam_to_cam.txt");
  calibration.T_cam_velo = readRotationTranslation(date_folder / "calib_velo_to_cam.txt");
  calibration.T_velo_imu = readRotationTranslation(date_folder / "calib_imu_to_velo.txt");
  return calibration;
}

}  // namespace motorcade
