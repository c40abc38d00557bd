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

/// The numbers of a key, and where they stand.
struct Values {
  std::string key;
  int line = 0;
  std::vector<double> numbers{};
};
using Keys = std::map<std::string, Values>;

constexpr std::size_t kMaxFile_bytes = std::size_t{1} << 20;

std::string placeOf(const std::filesystem::path& file, int line) {
  return file.string() + (line > 0 ? ", line " + std::to_string(line) : "");
}

[[noreturn]] void fail(const std::filesystem::path& file, const Values& values, const std::string& what) {
  throw InputError(placeOf(file, values.line) + ": key " + values.key + " " + what);
}

/// Keys to numbers. A value that is no list of numbers (calib_time, for one) is left out.
Keys readKeys(const std::filesystem::path& file) {
  Keys keys;
  for (const auto& line : readLines(file, LastLine::kKeep, kMaxFile_bytes)) {
    FieldReader fields(file, line);
    std::string key(fields.word("a key"));
    if (key.ends_with(':')) key.pop_back();
    if (key == "calib_time") continue;
    Values values{.key = key, .line = line.number};
    while (!fields.atEnd()) values.numbers.push_back(fields.number(key));
    keys.emplace(std::move(key), std::move(values));
  }
  return keys;
}

/// The first of several spellings that the file knows; its values must be `count` many.
const Values* find(const Keys& keys, const std::vector<std::string>& spellings, std::size_t count,
                   const std::filesystem::path& file) {
  for (const auto& spelling : spellings) {
    const auto found = keys.find(spelling);
    if (found == keys.end()) continue;
    const std::size_t has = found->second.numbers.size();
    if (has != count)
      fail(file, found->second, "has " + std::to_string(has) + " numbers, " + std::to_string(count) + " are needed");
    return &found->second;
  }
  return nullptr;
}

Eigen::Matrix<double, 3, 4> matrix34(const Values& v) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(v.numbers.data());
}
/// Fails for zeros, a reflection, and what else is no rotation.
SE3 rigid(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m, const Values& v,
          const std::filesystem::path& file) {
  if (!isRotation(rotation)) fail(file, v, "holds no rotation matrix");
  return SE3(rotation, translation_m).normalized();
}
SE3 rigid(const Values& v, const std::filesystem::path& file) {
  const auto m = matrix34(v);
  return rigid(m.leftCols<3>(), m.col(3), v, file);
}
SE3 rigid(const Values& v, const Eigen::Vector3d& translation_m, const std::filesystem::path& file) {
  return rigid(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.numbers.data()), translation_m, v,
               file);
}

/// `R:` and `T:` of the raw layout's files between two sensors.
std::optional<SE3> readRotationTranslation(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const auto keys = readKeys(file);
  const Values* R = find(keys, {"R"}, 9, file);
  const Values* T = find(keys, {"T"}, 3, file);
  if (!R || !T) throw InputError(file.string() + ": key R or T is missing");
  return rigid(*R, Eigen::Map<const Eigen::Vector3d>(T->numbers.data()), file);
}

void requireFocalLength(double focal_px, const std::string& name) {
  constexpr double kMost_px = 1e6;  // a pixel of a camera that sees one degree of a 16384 px wide image has 9e5
  if (!(focal_px > 0)) throw InputError(name + ": the focal lengths must be positive");
  if (focal_px < 1 || focal_px > kMost_px)
    throw InputError(name + ": a focal length is " + std::to_string(focal_px) +
                     " px; no camera has less than 1 px or more than 1e6");
}

/// Of a rectified camera without skew.
void requirePinhole(const Calibration::Projection& P, const std::string& name) {
  constexpr double kTolerance = 1e-6;
  const Eigen::Vector3d last_row(P(2, 0), P(2, 1), P(2, 2));
  const bool pinhole = (last_row - Eigen::Vector3d::UnitZ()).cwiseAbs().maxCoeff() < kTolerance &&
                       std::abs(P(0, 1)) < kTolerance * P(0, 0) && std::abs(P(1, 0)) < kTolerance * P(1, 1);
  if (!pinhole) throw InputError(name + ": its left 3x3 part must be fx 0 cx, 0 fy cy, 0 0 1");
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
  const std::string name = placeOf(file, line_of_P[left]) + ": key P" + std::to_string(left);
  requireFocalLength(P_left(0, 0), name);
  requireFocalLength(P_left(1, 1), name);
  requirePinhole(P_left, name);
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
  return SE3(*R_rect, Eigen::Vector3d::Zero()) * *T_cam_velo * *T_velo_imu;
}

Calibration readCalibration(const std::filesystem::path& file) {
  const auto keys = readKeys(file);
  Calibration calibration{.file = file};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i);
    if (const auto* v = find(keys, {"P" + n, "P_rect_0" + n}, 12, file)) {
      calibration.P[i] = matrix34(*v);
      calibration.line_of_P[i] = v->line;
    }
  }
  if (const auto* v = find(keys, {"R0_rect", "R_rect", "R_rect_00"}, 9, file))
    calibration.R_rect = rigid(*v, Eigen::Vector3d::Zero(), file).rotation();
  if (const auto* v = find(keys, {"Tr_velo_to_cam", "Tr_velo_cam"}, 12, file)) calibration.T_cam_velo = rigid(*v, file);
  if (const auto* v = find(keys, {"Tr_imu_to_velo", "Tr_imu_velo"}, 12, file)) calibration.T_velo_imu = rigid(*v, file);
  return calibration;
}

Calibration readRawCalibration(const std::filesystem::path& date_folder) {
  Calibration calibration = readCalibration(date_folder / "calib_cam_to_cam.txt");
  calibration.T_cam_velo = readRotationTranslation(date_folder / "calib_velo_to_cam.txt");
  calibration.T_velo_imu = readRotationTranslation(date_folder / "calib_imu_to_velo.txt");
  return calibration;
}

}  // namespace motorcade
