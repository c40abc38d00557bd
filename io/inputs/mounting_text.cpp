#include "io/inputs/mounting_text.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>

#include "io/files/errors.hpp"
#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr double kFarthestMounting_m = 50, kMostTurn_deg = 360;  // beyond, it is in other units

/// Three lengths in meters and three angles in degrees, or empty where the text has others.
std::optional<std::array<double, 6>> sixNumbersOf(const std::string& text) {
  std::array<double, 6> numbers{};
  std::istringstream stream(text + ",");
  std::size_t count = 0;
  for (std::string field; std::getline(stream, field, ','); ++count) {
    const auto number = numberIn(field);
    const double most = count < 3 ? kFarthestMounting_m : kMostTurn_deg;
    if (count >= numbers.size() || !number || std::abs(*number) > most) return std::nullopt;
    numbers[count] = *number;
  }
  if (count != numbers.size()) return std::nullopt;
  return numbers;
}

}  // namespace

SE3 parseMounting(const std::string& text) {
  const auto numbers = sixNumbersOf(text);
  if (!numbers)
    throw UsageError("--mounting " + printable(text) +
                     ": write X,Y,Z,ROLL,PITCH,YAW: where the left camera sits in the vehicle's frame, in meters (50 "
                     "at most), and how it is turned, in degrees");
  const auto& [x_m, y_m, z_m, roll_deg, pitch_deg, yaw_deg] = *numbers;
  constexpr double kRadians = std::numbers::pi / 180;  // per degree
  const auto turn = [](double angle_deg, int axis) {
    return expSO3(kRadians * angle_deg * Eigen::Vector3d::Unit(axis));
  };
  return {turn(yaw_deg, 2) * turn(pitch_deg, 1) * turn(roll_deg, 0), {x_m, y_m, z_m}};
}

}  // namespace motorcade
