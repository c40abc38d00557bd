#pragma once

#include <type_traits>

#include <Eigen/Core>

#include "core/se3.hpp"

namespace motorcade::test {

/// Central differences of `f` over a vector; exact to about 1e-8 for values of order one.
template <class Function, int N>
auto numericJacobian(const Function& f, const Eigen::Matrix<double, N, 1>& x, double step = 1e-6) {
  using Result = std::decay_t<decltype(f(x))>;
  Eigen::Matrix<double, Result::RowsAtCompileTime, N> J;
  if constexpr (N == Eigen::Dynamic) J.resize(f(x).rows(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::Matrix<double, N, 1> plus = x, minus = x;
    plus[i] += step;
    minus[i] -= step;
    J.col(i) = (f(plus) - f(minus)) / (2 * step);
  }
  return J;
}

/// The same over a right perturbation of `T`.
template <class Function>
auto numericJacobian(const Function& f, const SE3& T, double step = 1e-6) {
  return numericJacobian([&](const Vector6d& xi) { return f(T * SE3::exp(xi)); }, Vector6d::Zero().eval(), step);
}

}  // namespace motorcade::test
