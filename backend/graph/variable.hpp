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

/// A vector of at most six numbers, without a heap allocation.
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// Value of a variable: a pose in space (six dimensions), a pose in the plane (three), or a plain vector.
using Value = std::variant<SE3, SE2, SmallVector>;

inline int dimension(const Value& value) {
  if (const auto* vector = std::get_if<SmallVector>(&value)) return static_cast<int>(vector->size());
  return std::holds_alternative<SE3>(value) ? 6 : 3;
}

/// Moves a value by a step in the world's axes: a pose's origin moves by the first numbers [m], and it turns about its
/// origin by the last [rad]. A vector moves by addition.
Value displaced(const Value& value, const SmallVector& step);

/// The step with displaced(from, step) = to.
SmallVector displacement(const Value& from, const Value& to);

}  // namespace motorcade
