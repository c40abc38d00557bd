#pragma once

#include "backend/graph/variable.hpp"

namespace motorcade::test {

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

}  // namespace motorcade::test
