#pragma once

#include <vector>

#include <Eigen/Core>

#include "backend/graph/factor.hpp"
#include "backend/graph/variable.hpp"
#include "tests/backend/perturbation.hpp"
#include "tests/support/numeric_jacobian.hpp"

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
  Eigen::MatrixXd J(factor.rows(), 0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto residual = [&](const Eigen::VectorXd& step) {
      auto moved = values;
      moved[k] = move(values[k], step);
      return residualAt(factor, moved);
    };
    const int columns = dimension(values[k]);
    J.conservativeResize(Eigen::NoChange, J.cols() + columns);
    J.rightCols(columns) = numericJacobian(residual, Eigen::VectorXd::Zero(columns).eval());
  }
  return J;
}

}  // namespace motorcade::test
