#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <random>

#include <Eigen/Core>

#include "core/se3.hpp"

namespace motorcade::test {

/// Lower triangular L with L L^T = covariance, in plain loops: most tests include this file, and each would compile
/// Eigen's anew.
template <int N>
Eigen::Matrix<double, N, N> lowerRoot(const Eigen::Matrix<double, N, N>& covariance) {
  Eigen::Matrix<double, N, N> L = Eigen::Matrix<double, N, N>::Zero();
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      double left = covariance(i, j);
      for (int k = 0; k < j; ++k) left -= L(i, k) * L(j, k);
      L(i, j) = i == j ? std::sqrt(left) : left / L(j, j);
    }
  }
  return L;
}

/// Seeded draws for simulated measurements.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : generator_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  /// An integer in [0, n).
  template <std::integral Integer>
  Integer below(Integer n) {
    return static_cast<Integer>(uniform(0, static_cast<double>(n) - 1e-9));
  }
  double gaussian(double sigma = 1.0) { return sigma * normal_(generator_); }
  /// Draws independent components.
  template <int N>
  Eigen::Matrix<double, N, 1> gaussian(const Eigen::Matrix<double, N, 1>& sigma) {
    return sigma.unaryExpr([&](double s) { return gaussian(s); });
  }
  template <int N>
  Eigen::Matrix<double, N, 1> correlated(const Eigen::Matrix<double, N, N>& covariance) {
    const Eigen::Matrix<double, N, N> L = lowerRoot<N>(covariance);
    const auto draws = gaussian(Eigen::Matrix<double, N, 1>(Eigen::Matrix<double, N, 1>::Ones()));
    Eigen::Matrix<double, N, 1> drawn = Eigen::Matrix<double, N, 1>::Zero();
    for (int i = 0; i < N; ++i)
      for (int k = 0; k <= i; ++k) drawn[i] += L(i, k) * draws[k];
    return drawn;
  }
  Eigen::Vector3d inBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    return {uniform(low.x(), high.x()), uniform(low.y(), high.y()), uniform(low.z(), high.z())};
  }

 private:
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
};

/// A covariance without structure, its standard deviations around `sigma`.
template <int N>
Eigen::Matrix<double, N, N> randomCovariance(Noise& noise, const Eigen::Matrix<double, N, 1>& sigma) {
  Eigen::Matrix<double, N, N> A;
  for (int i = 0; i < N; ++i)
    A.col(i) = noise.gaussian(Eigen::Matrix<double, N, 1>(Eigen::Matrix<double, N, 1>::Ones()));
  A += 2 * Eigen::Matrix<double, N, N>::Identity();
  return sigma.asDiagonal() * (A * A.transpose() / (N + 4.0)) * sigma.asDiagonal();
}

/// Normalized error squared (NEES): chi-square with N degrees of freedom for an error with this covariance.
template <int N>
double nees(const Eigen::Matrix<double, N, 1>& error, const Eigen::Matrix<double, N, N>& covariance) {
  const Eigen::Matrix<double, N, N> L = lowerRoot<N>(covariance);
  Eigen::Matrix<double, N, 1> whitened = error;
  for (int i = 0; i < N; ++i) {
    for (int k = 0; k < i; ++k) whitened[i] -= L(i, k) * whitened[k];
    whitened[i] /= L(i, i);
  }
  return whitened.squaredNorm();
}

/// Half the width of the interval that holds the mean of n chi-square values with 95 % probability. The normal
/// approximation holds to a percent for the hundreds of draws that tests use.
inline double meanChi2Spread(double degrees_of_freedom, int n) { return 1.96 * std::sqrt(2 * degrees_of_freedom / n); }

}  // namespace motorcade::test
