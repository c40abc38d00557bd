#include "apps/export/osi_sensor_data.hpp"

#include <numbers>
#include <random>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "core/se3.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade {
namespace {

Eigen::Matrix3d turnedBy(double roll, double pitch, double yaw) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
          AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

TEST(EulerAngles, YawComesFirstThenPitchThenRoll) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turn(-3.1, 3.1), tilt(-1.5, 1.5);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d angles_rad(turn(random), tilt(random), turn(random));
    EXPECT_LT((eulerAngles_rad(turnedBy(angles_rad[0], angles_rad[1], angles_rad[2])) - angles_rad).norm(), 1e-9);
  }
  EXPECT_GT(eulerAngles_rad(turnedBy(0, 0, 0.5))[2], 0) << "to the left";
  EXPECT_GT(eulerAngles_rad(turnedBy(0, 0.5, 0))[1], 0) << "the front goes down";
}

TEST(EulerAngles, AVerticalAxisHasAnglesButNoRates) {
  for (const double pitch : {-std::numbers::pi / 2, std::numbers::pi / 2}) {
    const Eigen::Matrix3d up = turnedBy(0, pitch, 0.4);
    const Eigen::Vector3d angles_rad = eulerAngles_rad(up);
    EXPECT_LT((turnedBy(angles_rad[0], angles_rad[1], angles_rad[2]) - up).norm(), 1e-6);
    EXPECT_FALSE(eulerJacobian(angles_rad));
  }
}

TEST(EulerAngles, TheJacobianMatchesFiniteDifferences) {
  constexpr double kTol = 1e-8;  // error of central differences
  const Eigen::Matrix3d rotation = turnedBy(0.3, -0.7, 2.1);
  const auto J = eulerJacobian(eulerAngles_rad(rotation));
  ASSERT_TRUE(J);
  const auto anglesAfter_rad = [&](const Eigen::Vector3d& turn) { return eulerAngles_rad(rotation * expSO3(turn)); };
  EXPECT_THAT(*J, test::IsNear(test::numericJacobian(anglesAfter_rad, Eigen::Vector3d::Zero().eval()), kTol));
}

}  // namespace
}  // namespace motorcade
