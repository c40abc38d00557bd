#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Dense>

/// Results as matrices, and the truth of a rendered drive.
namespace motorcade {

using Transform = Eigen::Matrix4d;

inline Transform transformOf(const std::array<double, 12>& rows) {
  Transform T = Transform::Identity();
  T.topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(rows.data());
  return T;
}

template <std::size_t kCount>
auto squareOf(const std::array<double, kCount>& rows) {
  constexpr int kSide = kCount == 9 ? 3 : 6;
  return Eigen::Matrix<double, kSide, kSide, Eigen::RowMajor>(
      Eigen::Map<const Eigen::Matrix<double, kSide, kSide, Eigen::RowMajor>>(rows.data()));
}

inline Eigen::Vector3d vectorOf(const std::array<double, 3>& values) { return Eigen::Vector3d(values.data()); }

/// Lines of numbers.
inline std::vector<std::vector<double>> numbersIn(const std::string& file) {
  std::ifstream lines(file);
  std::vector<std::vector<double>> numbers;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream values(line);
    numbers.emplace_back(std::istream_iterator<double>(values), std::istream_iterator<double>());
  }
  return numbers;
}

inline std::array<double, 12> rowsAt(const std::vector<double>& numbers, std::size_t first) {
  std::array<double, 12> rows{};
  std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(first), 12, rows.begin());
  return rows;
}

struct Truth {
  std::vector<Transform> T_world_cam;
  std::vector<Transform> T_world_car;  // of the only one that moves, ahead
};

inline Truth readTruth(const std::string& folder) {
  Truth truth;
  for (const auto& line : numbersIn(folder + "/poses.txt")) truth.T_world_cam.push_back(transformOf(rowsAt(line, 0)));
  for (const auto& line : numbersIn(folder + "/object_poses.txt"))
    if (line[1] == 0) truth.T_world_car.push_back(transformOf(rowsAt(line, 3)));
  return truth;
}

}  // namespace motorcade
