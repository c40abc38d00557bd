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

}  // namespace motorcade
