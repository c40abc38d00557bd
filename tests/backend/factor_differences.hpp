#pragma once

#include <vector>

#include <Eigen/Core>

#include "backend/graph/factor.hpp"
#include "backend/graph/variable.hpp"
#include "tests/backend/perturbation.hpp"

namespace motorcade::test {

inline std::vector<const Value*> pointersTo(const std::vector<Value>& values) {
  std::vector<const Value*> pointers;
  for (const Value& value : values) pointers.push_back(&value);
  return pointers;
}

inline Eigen::VectorXd residualAt(const JacobianFactor& factor, const std::vector<Value>& values) {
  Eigen::VectorXd r(factor.rows());
  factor.residual(pointersTo(values), r);
  return r;
}

/// Central differences of the whitened residual, variable by variable; `move` says what a step of a value is: in its
/// own axes (retract) or in the world's (displaced).
inline Eigen::MatrixXd numericJacobian(const JacobianFactor& factor, const std::vector<Value>& values,
                                       Value (*move)(const Value&, const SmallVector&) = retract) {
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd J(factor.rows(), 0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (int i = 0; i < dimension(values[k]); ++i) {
      const SmallVector step = kStep * SmallVector::Unit(dimension(values[k]), i);
      auto plus = values, minus = values;
      plus[k] = move(values[k], step);
      minus[k] = move(values[k], -step);
      J.conservativeResize(Eigen::NoChange, J.cols() + 1);
      J.col(J.cols() - 1) = (residualAt(factor, plus) - residualAt(factor, minus)) / (2 * kStep);
    }
  }
  return J;
}

}  // namespace motorcade::test
