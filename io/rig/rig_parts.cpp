#include "io/rig/rig_parts.hpp"

#include <algorithm>
#include <cmath>

#include "io/image_limits.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

Eigen::Matrix3d rotationOf(const Eigen::Matrix3d& matrix, const YamlPart& part) {
  if (!isRotation(matrix)) part.fail("holds no rotation matrix");
  return SE3(matrix, Eigen::Vector3d::Zero()).normalized().rotation();
}

Distortion distortionNamed(const std::string& model, const YamlPart& part) {
  for (const char* name : {"radtan", "radial-tangential", "plumb_bob", "rational_polynomial"})
    if (model == name) return Distortion::kRadialTangential;
  for (const char* name : {"equidistant", "equi", "fisheye", "kannala_brandt"})
    if (model == name) return Distortion::kEquidistant;
  if (model.empty() || model == "none") return Distortion::kNone;
  part.fail("belongs to the distortion model '" + printable(model) +
            "', which is not known; calibrate with radtan (plumb_bob) or equidistant, or rectify the images yourself");
}

}  // namespace

Eigen::Matrix3d matrix33(const YamlPart& part) {
  const auto numbers = part.numbers(9);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

Eigen::Matrix3d rotation33(const YamlPart& part) { return rotationOf(matrix33(part), part); }

SE3 transform44(const YamlPart& part) {
  const auto numbers = part.numbers(16);
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  return {rotationOf(matrix.topLeftCorner<3, 3>(), part), matrix.topRightCorner<3, 1>()};
}

void setIntrinsics(LensCamera& camera, const YamlPart& part) {
  constexpr double kLeast_px = 1, kMost_px = 1e6;
  const auto numbers = part.numbers();
  if (numbers.size() == 4) {
    camera.fx_px = numbers[0], camera.fy_px = numbers[1], camera.cx_px = numbers[2], camera.cy_px = numbers[3];
  } else {
    const Eigen::Matrix3d K = matrix33(part);
    if (std::abs(K(0, 1)) > 1e-3 * K(0, 0) || K(1, 0) != 0 || K(2, 0) != 0 || K(2, 1) != 0 || K(2, 2) != 1)
      part.fail("must be fx 0 cx, 0 fy cy, 0 0 1");
    camera.fx_px = K(0, 0), camera.fy_px = K(1, 1), camera.cx_px = K(0, 2), camera.cy_px = K(1, 2);
  }
  for (const double focal_px : {camera.fx_px, camera.fy_px})
    if (!(focal_px >= kLeast_px && focal_px <= kMost_px)) part.fail("must have focal lengths from 1 to 1e6 px");
}

void setDistortion(LensCamera& camera, const std::string& model, const YamlPart& coefficients) {
  camera.distortion = distortionNamed(model, coefficients);
  std::vector<double> given = coefficients.numbers();
  while (given.size() > 4 && given.back() == 0) given.pop_back();  // of longer models, of which nothing is used
  const std::size_t most = camera.distortion == Distortion::kEquidistant ? 4 : camera.coefficients.size();
  if (given.size() > most)
    coefficients.fail("has " + std::to_string(given.size()) + " coefficients, " + std::to_string(most) +
                      " are understood");
  for (const double value : given)
    if (std::abs(value) > 1e6) coefficients.fail("holds a coefficient that no lens has");
  camera.coefficients = {};
  std::ranges::copy(given, camera.coefficients.begin());
  if (std::ranges::all_of(given, [](double value) { return value == 0; }) &&
      camera.distortion == Distortion::kRadialTangential)
    camera.distortion = Distortion::kNone;
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
