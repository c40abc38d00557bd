#pragma once

#include <string>
#include <string_view>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/rig/rig_file.hpp"
#include "tests/io/temporary_folder.hpp"

/// One rig in the forms of many makers: the right camera 0.11 m to the right, turned by 10 mrad about x.
namespace motorcade::test {

// p_right = R * p_left + t, and its inverse.
inline constexpr std::string_view kRightLeft =
    "1, 0, 0, -0.11, 0, 0.99995000041666528, -0.0099998333341666645, 0, 0, 0.0099998333341666645, "
    "0.99995000041666528, 0, 0, 0, 0, 1";
inline constexpr std::string_view kLeftRight =
    "1, 0, 0, 0.11, 0, 0.99995000041666528, 0.0099998333341666645, 0, 0, -0.0099998333341666645, "
    "0.99995000041666528, 0, 0, 0, 0, 1";
// A body whose x is the left camera's z, y its -x, z its -y; the left camera stands 1 m ahead and 0.2 m up.
inline constexpr std::string_view kBodyLeft = "0, 0, 1, 1, -1, 0, 0, 0, 0, -1, 0, 0.2, 0, 0, 0, 1";
inline constexpr std::string_view kBodyRight =
    "0, -0.0099998333341666645, 0.99995000041666528, 1, -1, 0, 0, -0.11, 0, -0.99995000041666528, "
    "-0.0099998333341666645, 0.2, 0, 0, 0, 1";
// The inverse of kBodyLeft.
inline constexpr std::string_view kLeftBody = "0, -1, 0, 0, 0, 0, -1, 0.2, 1, 0, 0, -1, 0, 0, 0, 1";

inline std::string braced(std::string_view numbers) { return std::string("[").append(numbers).append("]"); }
inline std::string matrix(std::string_view numbers, int rows = 4, int cols = 4) {
  return "!!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(cols) +
         "\n   dt: d\n   data: " + braced(numbers) + "\n";
}

class RigForms : public testing::Test {
 protected:
  Rig read(const std::string& content, const std::string& name = "file.yaml") {
    return readRig({folder_.write(name, content)});
  }
  Rig read(const std::string& left, const std::string& right, const std::string& extension) {
    return readRig({folder_.write("left" + extension, left), folder_.write("right" + extension, right)});
  }
  std::string errorOf(const std::string& content, const std::string& name = "file.yaml") {
    return messageOf<InputError>([&] { read(content, name); });
  }
  static void expectTransform(const Rig& rig) {
    EXPECT_NEAR(rig.T_right_left.translation().x(), -0.11, 1e-12);
    EXPECT_NEAR(rig.T_right_left.translation().tail<2>().norm(), 0, 1e-12);
    EXPECT_NEAR((logSO3(rig.T_right_left.rotation()) - Eigen::Vector3d(0.01, 0, 0)).norm(), 0, 1e-9);
    EXPECT_NEAR(rectificationOf(rig, {752, 480}).camera.baseline_m, 0.11, 1e-9);
  }
  /// Expects lenses that are about EuRoC's.
  static void expectLenses(const Rig& rig) {
    EXPECT_EQ(rig.left.fx_px, 458.6);
    EXPECT_EQ(rig.left.cy_px, 248.4);
    EXPECT_EQ(rig.right.fy_px, 456.1);
    EXPECT_EQ(rig.right.cx_px, 380);
    EXPECT_EQ(rig.left.distortion, Distortion::kRadialTangential);
    EXPECT_EQ(rig.left.coefficients[0], -0.28);
    EXPECT_EQ(rig.right.coefficients[3], 0.0001);
  }
  TemporaryFolder folder_;
};

}  // namespace motorcade::test
