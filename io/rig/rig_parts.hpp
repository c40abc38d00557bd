#pragma once

#include <array>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "io/rig/rectification.hpp"
#include "io/rig/yaml_file.hpp"

/// Parsers that the calibrations of different makers share.
namespace motorcade {

Eigen::Matrix3d matrix33(const YamlPart& part);
/// Reads a rotation from nine numbers and puts it back onto SO(3) from its printed digits. Fails if they are no
/// rotation.
Eigen::Matrix3d rotation33(const YamlPart& part);
/// Reads a transform from three or four rows of four numbers.
SE3 transform44(const YamlPart& part);
/// The difference of two transforms that must be one, as a message tells it; empty where they agree.
std::string disagreement(const SE3& a, const SE3& b);

/// The text of a key, or `otherwise` where it is missing.
std::string textOr(const YamlPart& part, std::initializer_list<std::string_view> keys, const std::string& otherwise);
/// Right camera from left where both are placed on one body.
SE3 betweenPlaced(const SE3& T_body_left, const SE3& T_body_right);

/// Sets the focal lengths and the principal point from fx fy cx cy, or from a matrix fx 0 cx, 0 fy cy, 0 0 1.
void setIntrinsics(LensCamera& camera, const YamlPart& part);
/// Sets them from fx fy cx cy of another place; errors name `part`.
void setIntrinsics(LensCamera& camera, const std::array<double, 4>& fx_fy_cx_cy, const YamlPart& part);
/// Sets the distortion from a model's name in any of the spellings in use, and its coefficients. Fails for coefficients
/// without a model.
void setDistortion(LensCamera& camera, const std::string& model, const YamlPart& coefficients);
void setDistortion(LensCamera& camera, const std::string& model, std::vector<double> coefficients,
                   const YamlPart& part);
/// Sets the distortion from another place. Returns what is wrong, to follow the name of the coefficients, or nothing.
std::string setDistortion(LensCamera& camera, const std::string& model, std::vector<double> coefficients);
/// Sets the distortion where OpenCV's calibration or ROS' names no model. Four coefficients may also be those of a
/// fish-eye lens: they are refused, unless no such lens has them.
void setDistortion(LensCamera& camera, const YamlPart& coefficients);
/// Width or height of an image; fails for an impossible value.
int imageSide(const YamlPart& part, double side_px);
/// Sets the size of the images from two numbers.
void setSize(LensCamera& camera, const YamlPart& part);

}  // namespace motorcade
