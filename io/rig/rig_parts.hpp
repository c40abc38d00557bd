#pragma once

#include <span>
#include <string>

#include "io/rig/rectification.hpp"
#include "io/rig/yaml_file.hpp"

/// What the calibrations of different makers have in common.
namespace motorcade {

Eigen::Matrix3d matrix33(const YamlPart& part);
/// Of nine numbers that must be a rotation's, which is put back onto SO(3) from its printed digits.
Eigen::Matrix3d rotation33(const YamlPart& part);
/// Of four rows of four numbers.
SE3 transform44(const YamlPart& part);

/// Sets the focal lengths and the principal point from fx fy cx cy, or from a matrix fx 0 cx, 0 fy cy, 0 0 1.
void setIntrinsics(LensCamera& camera, const YamlPart& part);
/// Sets the distortion from a model's name in any of the spellings in use, and its coefficients.
void setDistortion(LensCamera& camera, const std::string& model, const YamlPart& coefficients);
/// Width or height of an image; fails for what cannot be one.
int imageSide(const YamlPart& part, double side_px);
/// Sets the size of the images from two numbers.
void setSize(LensCamera& camera, const YamlPart& part);

}  // namespace motorcade
