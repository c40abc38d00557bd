#pragma once

#include <array>

#include <nlohmann/json_fwd.hpp>

#include "core/se3.hpp"

namespace motorcade {

/// A reliability diagram of covariances: it tells whether errors along each axis lie within an interval as often as
/// their standard deviation says. The interval of a probability q holds q of a normal distribution around zero.
struct AxisReliability {
  static constexpr int kAxes = 6, kTenths = 10;  // of (rho, phi), and of the probability
  static constexpr std::array<const char*, kAxes> kAxisNames = {"x", "y", "z", "about_x", "about_y", "about_z"};

  /// The errors between the intervals of successive tenths: equally many where deviations are right.
  std::array<std::array<int, kTenths>, kAxes> errors{};

  /// Variances are positive.
  void add(const Vector6d& error, const Matrix6d& covariance);
  void add(const AxisReliability& other);
  int samples() const;
  /// The share of errors within the interval of `tenths` tenths.
  double shareWithin(int axis, int tenths) const;
};

/// A list of `errors` for each axis, by its name.
nlohmann::ordered_json jsonOf(const AxisReliability& reliability);
/// Throws the library's exception for any other JSON.
AxisReliability axisReliabilityOf(const nlohmann::json& json);

}  // namespace motorcade
