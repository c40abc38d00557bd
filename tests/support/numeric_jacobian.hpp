#pragma once

#include <Eigen/Core>

#include "core/se3.hpp"

namespace motorcade::test {

/// Central differences of `f` over a right perturbation of `T`; exact to about 1e-8 for residuals of order one.
template <class Function>
auto numericJacobian(const Function& f, const SE3& T, double step = 1e-6) {
  using Result = std::decay_t<decltype(f(T))>;
  Eigen::Matrix<double, Result::RowsAtCompileTime, 6> J;
  for (int i = 0; i < 6; ++i) {
    Vector6d xi = Vector6d::Zero();
    xi[i] = step;
    J.col(i) = (f(T * SE3::exp(xi)) - f(T * SE3::exp(-xi))) / (2 * step);
  }
  return J;
}

/// Central differences of `f` over a vector.
template <class Function, int N>
auto numericJacobian(const Function& f, const Eigen::Matrix<double, N, 1>& x, double step = 1e-6) {
  using Result = std::decay_t<decltype(f(x))>;
  Eigen::Matrix<double, Result::RowsAtCompileTime, N> J;
  for (int i = 0; i < N; ++i) {
    Eigen::Matrix<double, N, 1> plus = x, minus = x;
    plus[i] += step;
    minus[i] -= step;
    J.col(i) = (f(plus) - f(minus)) / (2 * step);
  }
  return J;
}

}  // namespace motorcade::test
