#include "apps/evaluate/measures/axis_reliability.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <nlohmann/json.hpp>

namespace motorcade {

void AxisReliability::add(const Vector6d& error, const Matrix6d& covariance) {
  for (int axis = 0; axis < kAxes; ++axis) {
    const double sigmas = std::abs(error[axis]) / std::sqrt(covariance(axis, axis));
    const double probability = std::erf(sigmas / std::numbers::sqrt2);
    ++errors[axis][std::min(kTenths - 1, static_cast<int>(kTenths * probability))];
  }
}

void AxisReliability::add(const AxisReliability& other) {
  for (int axis = 0; axis < kAxes; ++axis)
    for (int tenth = 0; tenth < kTenths; ++tenth) errors[axis][tenth] += other.errors[axis][tenth];
}

int AxisReliability::samples() const { return std::accumulate(errors[0].begin(), errors[0].end(), 0); }

double AxisReliability::shareWithin(int axis, int tenths) const {
  const auto& of_axis = errors[axis];
  return static_cast<double>(std::accumulate(of_axis.begin(), of_axis.begin() + tenths, 0)) / samples();
}

nlohmann::ordered_json jsonOf(const AxisReliability& reliability) {
  nlohmann::ordered_json json;
  for (int axis = 0; axis < AxisReliability::kAxes; ++axis)
    json[AxisReliability::kAxisNames[axis]] = reliability.errors[axis];
  return json;
}

AxisReliability axisReliabilityOf(const nlohmann::json& json) {
  AxisReliability reliability;
  for (int axis = 0; axis < AxisReliability::kAxes; ++axis)
    json.at(AxisReliability::kAxisNames[axis]).get_to(reliability.errors[axis]);
  return reliability;
}

}  // namespace motorcade
