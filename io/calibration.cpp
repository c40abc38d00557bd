#include "io/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "io/errors.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

using Values = std::vector<double>;

/// Keys to numbers. A value that is no list of numbers (calib_time, for one) is left out.
std::map<std::string, Values> readKeys(const std::filesystem::path& file) {
  std::map<std::string, Values> keys;
  for (const auto& line : readLines(file)) {
    FieldReader fields(file, line);
    std::string key(fields.word("a key"));
    if (key.ends_with(':')) key.pop_back();
    if (key == "calib_time") continue;
    Values values;
    while (!fields.atEnd()) values.push_back(fields.number(key));
    keys.emplace(std::move(key), std::move(values));
  }
  return keys;
}

/// The first of several spellings that the file knows; its values must be `count` many.
const Values* find(const std::map<std::string, Values>& keys, const std::vector<std::string>& spellings,
                   std::size_t count, const std::filesystem::path& file) {
  for (const auto& spelling : spellings) {
    const auto found = keys.find(spelling);
    if (found == keys.end()) continue;
    if (found->second.size() != count) {
      throw InputError(file.string() + ": key " + spelling + " has " + std::to_string(found->second.size()) +
                       " numbers, " + std::to_string(count) + " are needed");
    }
    return &found->second;
  }
  return nullptr;
}

Eigen::Matrix<double, 3, 4> matrix34(const Values& v) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(v.data());
}
Eigen::Matrix3d matrix33(const Values& v) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
}
SE3 rigid(const Values& v) {
  const auto m = matrix34(v);
  return SE3(m.leftCols<3>(), m.col(3)).normalized();
}

/// `R:` and `T:` of the raw layout's files between two sensors.
std::optional<SE3> readRotationTranslation(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const auto keys = readKeys(file);
  const Values* R = find(keys, {"R"}, 9, file);
  const Values* T = find(keys, {"T"}, 3, file);
  if (!R || !T) throw InputError(file.string() + ": key R or T is missing");
  return SE3(matrix33(*R), Eigen::Map<const Eigen::Vector3d>(T->data())).normalized();
}

}  // namespace

StereoCamera Calibration::stereoCamera(CameraPair pair) const {
  const std::size_t left = pair == CameraPair::kGray ? 0 : 2;
  for (const std::size_t i : {left, left + 1}) {
    if (!P[i]) {
      throw InputError(file.string() + ": key P" + std::to_string(i) + " is missing; the images are those of cameras " +
                       std::to_string(left) + " and " + std::to_string(left + 1));
    }
  }
  const Projection &P_left = *P[left], &P_right = *P[left + 1];
  const std::string name = file.string() + ": key P" + std::to_string(left);
  if (!(P_left(0, 0) > 0) || !(P_left(1, 1) > 0)) throw InputError(name + ": the focal lengths must be positive");
  const double tolerance_px = 1e-3 * P_left(0, 0);
  if ((P_left.leftCols<3>() - P_right.leftCols<3>()).cwiseAbs().maxCoeff() > tolerance_px) {
    throw InputError(name + " and P" + std::to_string(left + 1) +
                     " differ in their left 3x3 part: the pair is not rectified");
  }
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
  return SE3(*R_rect, Eigen::Vector3d::Zero()).normalized() * *T_cam_velo * *T_velo_imu;
}

Calibration readCalibration(const std::filesystem::path& file) {
  const auto keys = readKeys(file);
  Calibration calibration{.file = file};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i);
    if (const auto* v = find(keys, {"P" + n, "P_rect_0" + n}, 12, file)) calibration.P[i] = matrix34(*v);
  }
  if (const auto* v = find(keys, {"R0_rect", "R_rect", "R_rect_00"}, 9, file)) calibration.R_rect = matrix33(*v);
  if (const auto* v = find(keys, {"Tr_velo_to_cam", "Tr_velo_cam"}, 12, file)) calibration.T_cam_velo = rigid(*v);
  if (const auto* v = find(keys, {"Tr_imu_to_velo", "Tr_imu_velo"}, 12, file)) calibration.T_velo_imu = rigid(*v);
  return calibration;
}

Calibration readRawCalibration(const std::filesystem::path& date_folder) {
  Calibration calibration = readCalibration(date_folder / "calib_cam_to_cam.txt");
  calibration.T_cam_velo = readRotationTranslation(date_folder / "calib_velo_to_cam.txt");
  calibration.T_velo_imu = readRotationTranslation(date_folder / "calib_imu_to_velo.txt");
  return calibration;
}

}  // namespace motorcade
