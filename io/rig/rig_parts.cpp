#include "io/rig/rig_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "io/files/text_file.hpp"
#include "io/images/image_limits.hpp"

namespace motorcade {
namespace {

Eigen::Matrix3d rotationOf(const Eigen::Matrix3d& matrix, const YamlPart& part) {
  if (!isRotation(matrix)) part.fail("holds no rotation matrix");
  return SE3(matrix, Eigen::Vector3d::Zero()).normalized().rotation();
}

std::optional<Distortion> distortionNamed(const std::string& model) {
  for (const char* name : {"radtan", "radial-tangential", "radialtangential", "radialtangential8", "radtan8",
                           "plumb_bob", "rational_polynomial", "perspective"})
    if (model == name) return Distortion::kRadialTangential;
  for (const char* name : {"equidistant", "equi", "fisheye", "kannala_brandt", "kb4"})
    if (model == name) return Distortion::kEquidistant;
  if (model.empty() || model == "none") return Distortion::kNone;
  return std::nullopt;
}

}  // namespace

Eigen::Matrix3d matrix33(const YamlPart& part) {
  const auto numbers = part.numbers(9);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

Eigen::Matrix3d rotation33(const YamlPart& part) { return rotationOf(matrix33(part), part); }

SE3 transform44(const YamlPart& part) {
  const auto numbers = part.numbers();
  if (numbers.size() != 12 && numbers.size() != 16)
    part.fail("has " + std::to_string(numbers.size()) + " numbers, 16 are needed");
  const Eigen::Matrix<double, 3, 4> matrix =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data());
  if (numbers.size() == 16 && (numbers[12] != 0 || numbers[13] != 0 || numbers[14] != 0 || numbers[15] != 1))
    part.fail("must end with a row 0 0 0 1; is it written column by column?");
  return {rotationOf(matrix.leftCols<3>(), part), matrix.col(3)};
}

std::string disagreement(const SE3& a, const SE3& b) {
  constexpr double kMostTurn_rad = 0.0035, kMostShare = 0.02;  // what files with few digits differ by is far less
  const double turn_rad = logSO3(a.rotation().transpose() * b.rotation()).norm();
  const double distance_m = (a.translation() - b.translation()).norm();
  if (turn_rad < kMostTurn_rad && distance_m <= kMostShare * a.translation().norm()) return {};
  return std::to_string(1e3 * distance_m) + " mm and " + std::to_string(turn_rad * 180 / std::numbers::pi) + " degrees";
}

std::string textOr(const YamlPart& part, std::initializer_list<std::string_view> keys, const std::string& otherwise) {
  const auto found = part.find(keys);
  return found ? found->text() : otherwise;
}

SE3 betweenPlaced(const SE3& T_body_left, const SE3& T_body_right) { return T_body_right.inverse() * T_body_left; }

void setIntrinsics(LensCamera& camera, const YamlPart& part) {
  const auto numbers = part.numbers();
  if (numbers.size() == 4) return setIntrinsics(camera, {numbers[0], numbers[1], numbers[2], numbers[3]}, part);
  const Eigen::Matrix3d K = matrix33(part);
  if (K(2, 2) == 1 && K(0, 2) == 0 && K(1, 2) == 0 && K(2, 0) > 0 && K(2, 1) > 0)
    part.fail(
        "is transposed, as MATLAB's IntrinsicMatrix: write fx 0 cx, 0 fy cy, 0 0 1, and transpose MATLAB's "
        "rotation, too");
  if (std::abs(K(0, 1)) > 1e-3 * K(0, 0) || K(1, 0) != 0 || K(2, 0) != 0 || K(2, 1) != 0 || K(2, 2) != 1)
    part.fail("must be fx 0 cx, 0 fy cy, 0 0 1");
  setIntrinsics(camera, {K(0, 0), K(1, 1), K(0, 2), K(1, 2)}, part);
}

void setIntrinsics(LensCamera& camera, const std::array<double, 4>& fx_fy_cx_cy, const YamlPart& part) {
  constexpr double kLeast_px = 1, kMost_px = 1e6;
  camera.fx_px = fx_fy_cx_cy[0], camera.fy_px = fx_fy_cx_cy[1];
  camera.cx_px = fx_fy_cx_cy[2], camera.cy_px = fx_fy_cx_cy[3];
  for (const double focal_px : {camera.fx_px, camera.fy_px})
    if (!(focal_px >= kLeast_px && focal_px <= kMost_px)) part.fail("must have focal lengths from 1 to 1e6 px");
}

namespace {

bool areZeros(const std::vector<double>& coefficients) {
  return std::ranges::all_of(coefficients, [](double value) { return value == 0; });
}

}  // namespace

std::string setDistortion(LensCamera& camera, const std::string& model, std::vector<double> coefficients) {
  const auto distortion = distortionNamed(model);
  if (!distortion)
    return "belongs to the distortion model '" + printable(model) +
           "', which is not understood; calibrate with radtan (plumb_bob) or equidistant, or rectify the images "
           "yourself";
  camera.distortion = *distortion;
  while (coefficients.size() > 4 && coefficients.back() == 0) coefficients.pop_back();  // of longer models, not used
  const std::size_t most = camera.distortion == Distortion::kEquidistant ? 4 : camera.coefficients.size();
  if (coefficients.size() > most)
    return "has " + std::to_string(coefficients.size()) + " coefficients, " + std::to_string(most) + " are understood";
  if (std::ranges::any_of(coefficients, [](double value) { return std::abs(value) > 1e6; }))
    return "holds a coefficient that no lens has";
  if (camera.distortion == Distortion::kNone && !areZeros(coefficients))
    return "belongs to no model; add distortion_model: radtan or equidistant beside it";
  camera.coefficients = {};
  std::ranges::copy(coefficients, camera.coefficients.begin());
  if (areZeros(coefficients) && camera.distortion == Distortion::kRadialTangential)
    camera.distortion = Distortion::kNone;
  return {};
}

void setDistortion(LensCamera& camera, const std::string& model, std::vector<double> coefficients,
                   const YamlPart& part) {
  const std::string problem = setDistortion(camera, model, std::move(coefficients));
  if (!problem.empty()) part.fail(problem);
}

void setDistortion(LensCamera& camera, const std::string& model, const YamlPart& coefficients) {
  setDistortion(camera, model, coefficients.numbers(), coefficients);
}

/// Fish-eye lenses lie between the orthographic image, whose first coefficient is -1/6, and the pinhole's (1/3). The
/// tangential coefficients of other lenses are a few thousandths.
void setDistortion(LensCamera& camera, const YamlPart& coefficients) {
  constexpr double kBelowFishEyes = -0.2, kMostTangential = 0.01;
  const std::vector<double> given = coefficients.numbers();
  const auto is_radial = [&] {
    return given[0] < kBelowFishEyes && std::abs(given[2]) < kMostTangential && std::abs(given[3]) < kMostTangential;
  };
  if (given.size() == 4 && !areZeros(given) && !is_radial())
    coefficients.fail(
        "has four coefficients, which a fish-eye model and a radial-tangential one may mean; add a line "
        "distortion_model: equidistant (of OpenCV's fisheye), or distortion_model: radtan (k1 k2 p1 p2)");
  setDistortion(camera, "radtan", given, coefficients);
}

int imageSide(const YamlPart& part, double side_px) {
  if (!(side_px >= 1 && side_px <= kMaxImage_pixels)) part.fail("is no size of an image");
  return static_cast<int>(side_px);
}

void setSize(LensCamera& camera, const YamlPart& part) {
  const auto numbers = part.numbers(2);
  camera.size = {imageSide(part, numbers[0]), imageSide(part, numbers[1])};
}

}  // namespace motorcade
