#pragma once

#include <optional>

#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

/// The middle of an object's cuboid, which messages use as its pose. Without a cuboid it is the body's origin.
namespace motorcade {

/// T_body_box: the box has the body's axes.
SE3 boxInBody(const Result::Object& object);

/// The covariance of the box's pose as seen from the camera, right perturbation; empty where the object's is not known.
/// The body's T exp(xi) is the box's T_box exp(Ad(T_box_body) xi). The variances of the cuboid's middle in the body are
/// added.
std::optional<Matrix6d> boxCovariance(const Result::Object& object);

}  // namespace motorcade
