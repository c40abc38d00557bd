#pragma once

#include <variant>

#include <Eigen/Core>

#include "core/ids.hpp"
#include "core/se2.hpp"
#include "core/se3.hpp"

namespace motorcade {

/// Names a variable or a factor of one solver. An id may be given out again after its owner is gone.
using VariableId = Id<struct VariableTag>;
using FactorId = Id<struct FactorTag>;

/// At most six numbers, without a heap allocation.
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// What a variable holds: a pose in space (six dimensions), a pose in the plane (three), or a plain vector.
using Value = std::variant<SE3, SE2, SmallVector>;

inline int dimension(const Value& value) {
  if (const auto* vector = std::get_if<SmallVector>(&value)) return static_cast<int>(vector->size());
  return std::holds_alternative<SE3>(value) ? 6 : 3;
}

/// Poses move by a right perturbation, vectors by addition.
inline Value retract(const Value& value, const SmallVector& delta) {
  if (const auto* pose = std::get_if<SE3>(&value)) return (*pose * SE3::exp(delta)).normalized();
  if (const auto* pose = std::get_if<SE2>(&value)) return *pose * SE2::exp(delta);
  return SmallVector(std::get<SmallVector>(value) + delta);
}

/// The delta with retract(from, delta) = to.
inline SmallVector local(const Value& from, const Value& to) {
  if (const auto* pose = std::get_if<SE3>(&from)) return (pose->inverse() * std::get<SE3>(to)).log();
  if (const auto* pose = std::get_if<SE2>(&from)) return (pose->inverse() * std::get<SE2>(to)).log();
  return std::get<SmallVector>(to) - std::get<SmallVector>(from);
}

/// A step in the world's axes: a pose's origin moves by the first numbers [m], and it turns about its origin by the
/// last [rad]. A vector moves by addition.
inline Value displaced(const Value& value, const SmallVector& step) {
  if (const auto* pose = std::get_if<SE3>(&value)) {
    const Eigen::Matrix3d turn = expSO3(step.tail<3>());
    return SE3(turn * pose->rotation(), pose->translation() + step.head<3>()).normalized();
  }
  if (const auto* pose = std::get_if<SE2>(&value))
    return SE2(pose->angle_rad() + step[2], pose->translation() + step.head<2>());
  return SmallVector(std::get<SmallVector>(value) + step);
}

/// The step with displaced(from, step) = to.
inline SmallVector displacement(const Value& from, const Value& to) {
  SmallVector step(dimension(from));
  if (const auto* pose = std::get_if<SE3>(&from)) {
    const auto& moved = std::get<SE3>(to);
    step << moved.translation() - pose->translation(), logSO3(moved.rotation() * pose->rotation().transpose());
  } else if (const auto* planar = std::get_if<SE2>(&from)) {
    const auto& moved = std::get<SE2>(to);
    step << moved.translation() - planar->translation(),
        SE2(moved.angle_rad() - planar->angle_rad(), {0, 0}).angle_rad();
  } else {
    step = std::get<SmallVector>(to) - std::get<SmallVector>(from);
  }
  return step;
}

}  // namespace motorcade
