#include "apps/draw/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

/// Linear light of a color as screens have it (IEC 61966-2-1).
Vector3d linearOf(Color color) {
  const auto light = [](int level) {
    const double value = level / 255.0;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  };
  return {light(color.red), light(color.green), light(color.blue)};
}

/// CIE L*a*b* under D65, in which distances are about as large as they look.
Vector3d labOf(const Vector3d& linear) {
  Matrix3d to_xyz;
  to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const Vector3d xyz = (to_xyz * linear).cwiseQuotient(Vector3d(0.9505, 1, 1.089));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const Vector3d v(f(xyz.x()), f(xyz.y()), f(xyz.z()));
  return {116 * v.y() - 16, 500 * (v.x() - v.y()), 200 * (v.y() - v.z())};
}

/// Eyes without one kind of cones (Machado, Oliveira and Fernandes, A physiologically-based model for simulation of
/// color vision deficiency, 2009, severity 1); the first ones see all colors.
std::array<Matrix3d, 3> eyes() {
  std::array<Matrix3d, 3> eyes;
  eyes[0].setIdentity();
  eyes[1] << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998;
  eyes[2] << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
  return eyes;
}

/// The smallest difference between two colors over all eyes, in L*a*b*.
double distance(Color a, Color b) {
  double least = 1e9;
  for (const Matrix3d& eye : eyes()) {
    const auto seen = [&eye](Color color) -> Vector3d {
      return labOf((eye * linearOf(color)).cwiseMax(0.0).cwiseMin(1.0));
    };
    least = std::min(least, (seen(a) - seen(b)).norm());
  }
  return least;
}

constexpr double kClearly = 25;  // about ten times what is just seen side by side

TEST(Palette, NoObjectLooksLikeTheCamera) {
  constexpr Color kCameraOfPages{108, 178, 255};
  for (std::int64_t track = 0; track < static_cast<std::int64_t>(kTrackColors); ++track) {
    EXPECT_GT(distance(trackColor({track}), kOwn), kClearly) << track;
    EXPECT_GT(distance(trackColor({track}), kCameraOfPages), kClearly) << track;
  }
}

TEST(Palette, TracksThatFollowEachOtherDiffer) {
  for (std::int64_t track = 0; track < static_cast<std::int64_t>(kTrackColors); ++track)
    EXPECT_GT(distance(trackColor({track}), trackColor({track + 1})), kClearly - 5) << track;
}

TEST(Palette, AllColorsStandOutOnTheirGround) {
  const auto light = [](Color color) { return Vector3d(0.2126, 0.7152, 0.0722).dot(linearOf(color)); };
  for (std::int64_t track = 0; track < static_cast<std::int64_t>(kTrackColors); ++track)
    EXPECT_GT((light(trackColor({track})) + 0.05) / (light(kBackdrop) + 0.05), 3) << "the contrast that WCAG asks for";
}

}  // namespace
}  // namespace motorcade
