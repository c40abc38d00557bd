#pragma once

#include <array>
#include <optional>

#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

/// The middle of an object's cuboid, which is what messages have as its pose; where no cuboid is known, the body's
/// origin.
namespace motorcade {

/// Deviations of a cuboid's middle along the body's axes in those of its size: medians over the objects' rows of two
/// KITTI drives and four rendered ones, where they are 1.3 to 1.9, 0.8 to 1.5 and 0.6 to 0.8.
inline constexpr std::array<double, 3> kMiddlePerSize{1.5, 1.0, 0.7};

/// T_body_box: the box has the body's axes.
SE3 boxInBody(const Result::Object& object);

/// Of a perturbation on the right of the box's pose, as seen from the camera; empty where the object's is not known.
/// The body's T exp(xi) is the box's T_box exp(Ad(T_box_body) xi). How unsure the cuboid's middle is in the body, a
/// result does not tell: `kMiddlePerSize` times as unsure as its length, width and height.
std::optional<Matrix6d> boxCovariance(const Result::Object& object);

}  // namespace motorcade
