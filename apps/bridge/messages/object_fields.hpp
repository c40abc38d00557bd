#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "apps/bridge/messages/ros_objects.hpp"
#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

/// Fields of messages about objects.
namespace motorcade {

// Matrices of results and messages, which have them row by row.

template <int kSize>
Eigen::Matrix<double, kSize, kSize> matrixOf(const std::array<double, std::size_t{kSize} * kSize>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(rows.data());
}

template <int kSize>
std::array<double, std::size_t{kSize} * kSize> rowsOf(const Eigen::Matrix<double, kSize, kSize>& matrix) {
  std::array<double, std::size_t{kSize} * kSize> rows{};
  Eigen::Map<Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(rows.data()) = matrix;
  return rows;
}

/// The upper three rows.
inline std::array<double, 12> rowsOf(const SE3& T) {
  std::array<double, 12> rows{};
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(rows.data());
  matrix << T.rotation(), T.translation();
  return rows;
}

inline Eigen::Vector3d vectorFrom(const std::array<double, 3>& values) { return Eigen::Vector3d(values.data()); }

// The middle of an object's cuboid, which messages use as its pose. Without a cuboid it is the body's origin.

/// T_body_box: the box has the body's axes.
SE3 boxInBody(const Result::Object& object);

/// The covariance of the box's pose as seen from the camera, right perturbation; empty where the object's is not known.
/// The body's T exp(xi) is the box's T_box exp(Ad(T_box_body) xi). The variances of the cuboid's middle in the body are
/// added.
std::optional<Matrix6d> boxCovariance(const Result::Object& object);

struct KindShare {
  Result::Kind kind = Result::Kind::kUnknown;
  double probability = 0;
};

/// Possible kinds of an object: the one that the tracker names, and unknown with the rest. The shares sum to one. All
/// is unknown where no kind is named: the tracker's probability is then that of a kind that it does not publish.
std::vector<KindShare> kindShares(const Result::Object& object);

/// An object's id as a UUID of version 8 (RFC 9562). It has 60 bits of the microseconds of the first stamp of its
/// tracker's drive, and 62 bits of the tracker's id. Objects of different passes have different ones; a drive that is
/// played again has the same.
ros::Uuid uuidOf(std::int64_t object, std::int64_t first_stamp_ns);

/// The usual text, as 0125d8e3-1b2c-8f00-8000-000000000007.
std::string textOf(const ros::Uuid& uuid);

}  // namespace motorcade
