#include "vehicle_frame.hpp"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace vehicle_stack {
namespace {

using motorcade::Result;
using Covariance = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

const Mounting kMounting{.x_m = 1.7, .y_m = 0.2, .z_m = 1.5, .roll_rad = 0.02, .pitch_rad = 0.1, .yaw_rad = -0.3};

template <std::size_t kRows, std::size_t kColumns>
auto eigen(const Matrix<kRows, kColumns>& matrix) {
  Eigen::Matrix<double, int{kRows}, int{kColumns}> copy;
  for (std::size_t i = 0; i < kRows; ++i)
    for (std::size_t j = 0; j < kColumns; ++j) copy(static_cast<int>(i), static_cast<int>(j)) = matrix(i, j);
  return copy;
}

std::array<double, 12> rowsOf(const Eigen::Isometry3d& T) {
  std::array<double, 12> rows{};
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(rows.data()) = T.matrix().topRows<3>();
  return rows;
}

Eigen::Isometry3d poseOf(const Eigen::Vector3d& t_m, const Eigen::Vector3d& angles_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(t_m);
  T.rotate(Eigen::AngleAxisd(angles_rad.norm(), angles_rad.normalized()));
  return T;
}

/// T exp(rho, phi) for small perturbations.
Eigen::Isometry3d perturbed(const Eigen::Isometry3d& T, const Vector6& xi) {
  return T * poseOf(xi.head<3>(), xi.tail<3>());
}

/// A covariance of full rank, with all its parts related.
template <int kSize>
Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor> someCovariance(double sigma) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Eigen::Matrix<double, kSize, kSize> A =
      Eigen::Matrix<double, kSize, kSize>::NullaryExpr([&] { return normal(random); });
  return sigma * sigma * (A * A.transpose());
}

template <class Matrix>
auto arrayOf(const Matrix& matrix) {
  std::array<double, std::size_t{Matrix::SizeAtCompileTime}> rows{};
  std::copy_n(matrix.data(), rows.size(), rows.begin());
  return rows;
}

struct Seen {
  Result result;
  Result::Object object;
  Eigen::Isometry3d T_cam_body;
};

Seen someSeenObject() {
  Seen seen;
  seen.T_cam_body = poseOf({14, 3, -0.8}, {0.1, -0.05, 0.9});
  seen.object.T_cam_body = rowsOf(seen.T_cam_body);
  seen.object.covariance = arrayOf(someCovariance<6>(0.01));
  seen.object.velocity_world_mps = {9, -4, 0.3};
  seen.object.velocity_covariance = arrayOf(someCovariance<3>(0.4));
  seen.object.box_center_body_m = {1.6, -0.5, 0.2};
  seen.object.box_size_m = {4.2, 1.8, 1.5};
  seen.result.T_world_cam = rowsOf(poseOf({120, -40, 1}, {0.2, 0.1, -2}));
  return seen;
}

Eigen::Matrix3d vehicleFromCamera(const Mounting& mounting) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(mounting.yaw_rad, Eigen::Vector3d::UnitZ()) *
          AngleAxisd(mounting.pitch_rad, Eigen::Vector3d::UnitY()) *
          AngleAxisd(mounting.roll_rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

TEST(VehicleFrame, APointOnTheAxisOfACameraThatLooksDownIsLowerTheFartherItIs) {
  Result::Object object;
  object.T_cam_body = rowsOf(poseOf({10, 0, 0}, {0, 0, 0.1}));
  const VehicleFrame frame({.x_m = 2, .z_m = 1.5, .pitch_rad = 0.1}, 1);
  const Vector3 position_m = frame.object({.T_world_cam = rowsOf(Eigen::Isometry3d::Identity())}, object).position_m;
  EXPECT_NEAR(position_m.values[0], 2 + 10 * std::cos(0.1), 1e-12);
  EXPECT_NEAR(position_m.values[1], 0, 1e-12);
  EXPECT_NEAR(position_m.values[2], 1.5 - 10 * std::sin(0.1), 1e-12);
}

TEST(VehicleFrame, ACameraThatLooksToTheLeftSeesWhatIsLeftOfTheVehicle) {
  Result::Object object;
  object.T_cam_body = rowsOf(poseOf({10, 0, 0}, {0, 0, 0.1}));
  const VehicleFrame frame({.z_m = 1.5, .yaw_rad = 0.2}, 1);
  EXPECT_GT(frame.object({.T_world_cam = rowsOf(Eigen::Isometry3d::Identity())}, object).position_m.values[1], 1.9);
}

TEST(VehicleFrame, APoseIsThatOfTheMountingTimesThatInTheCamera) {
  const Seen seen = someSeenObject();
  const VehicleObject object = VehicleFrame(kMounting, 1).object(seen.result, seen.object);
  const Eigen::Matrix3d R = vehicleFromCamera(kMounting);
  const Eigen::Vector3d mounted_m(kMounting.x_m, kMounting.y_m, kMounting.z_m);
  const Eigen::Vector3d center_body_m(seen.object.box_center_body_m.data());
  EXPECT_TRUE(eigen(object.position_m).isApprox(R * seen.T_cam_body.translation() + mounted_m));
  EXPECT_TRUE(eigen(object.R_vehicle_body).isApprox(R * seen.T_cam_body.linear()));
  EXPECT_TRUE(eigen(object.box->center_m).isApprox(R * (seen.T_cam_body * center_body_m) + mounted_m));
}

/// Perturbs the pose in the camera as its covariance says, and gathers the poses in the vehicle.
TEST(VehicleFrame, CovariancesOfPoseAndBoxAreThoseOfManyPerturbedPoses) {
  constexpr int kSamples = 40'000;
  constexpr double kTolerance = 0.04;  // eight standard errors of a sample variance, relative
  const Seen seen = someSeenObject();
  const VehicleFrame frame(kMounting, 1);
  const VehicleObject mean = frame.object(seen.result, seen.object);
  const Eigen::Matrix<double, 6, 6> root = Covariance(seen.object.covariance->data()).llt().matrixL();
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 6, 6> pose = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix3d center = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    Seen other = seen;
    const Vector6 xi = root * Vector6::NullaryExpr([&] { return normal(random); });
    other.object.T_cam_body = rowsOf(perturbed(seen.T_cam_body, xi));
    const VehicleObject moved = frame.object(other.result, other.object);
    const Eigen::AngleAxisd turn(eigen(moved.R_vehicle_body) * eigen(mean.R_vehicle_body).transpose());
    Vector6 difference;
    difference << eigen(moved.position_m) - eigen(mean.position_m), turn.angle() * turn.axis();
    const Eigen::Vector3d of_center = eigen(moved.box->center_m) - eigen(mean.box->center_m);
    pose += difference * difference.transpose() / kSamples;
    center += of_center * of_center.transpose() / kSamples;
  }
  const auto largest = [](const auto& matrix) { return matrix.cwiseAbs().maxCoeff(); };
  EXPECT_LT(largest(pose - eigen(*mean.pose_covariance)), kTolerance * largest(pose));
  EXPECT_LT(largest(center - eigen(*mean.box->center_covariance)), kTolerance * largest(center));
}

TEST(VehicleFrame, VelocityOverGroundIsTurnedIntoTheVehiclesAxesWithItsCovariance) {
  const Seen seen = someSeenObject();
  const VehicleFrame frame(kMounting, 1);
  const VehicleObject object = frame.object(seen.result, seen.object);
  const Eigen::Isometry3d T_world_cam = poseOf({120, -40, 1}, {0.2, 0.1, -2});
  const Eigen::Matrix3d R = vehicleFromCamera(kMounting) * T_world_cam.linear().transpose();
  const Eigen::Vector3d velocity_mps(seen.object.velocity_world_mps.data());
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> C(seen.object.velocity_covariance.data());
  EXPECT_TRUE(eigen(object.velocity_mps).isApprox(R * velocity_mps));
  EXPECT_TRUE(eigen(object.velocity_covariance).isApprox(R * C * R.transpose()));
}

/// A vehicle that moves with a steady twist: its camera's twist follows from two poses of it, a short time apart.
TEST(VehicleFrame, TheVehiclesMotionIsFoundAgainFromThatOfItsCamera) {
  constexpr double kStep_s = 1e-6;
  const Vector6 twist{12, -0.3, 0.1, 0.02, -0.05, 0.4};
  Eigen::Isometry3d T_vehicle_cam = Eigen::Isometry3d::Identity();
  T_vehicle_cam.translate(Eigen::Vector3d(kMounting.x_m, kMounting.y_m, kMounting.z_m));
  T_vehicle_cam.rotate(vehicleFromCamera(kMounting));
  const Eigen::Isometry3d moved =
      T_vehicle_cam.inverse() * perturbed(Eigen::Isometry3d::Identity(), kStep_s * twist) * T_vehicle_cam;
  const Eigen::AngleAxisd turn(moved.linear());
  Result result;
  Eigen::Map<Eigen::Vector3d>(result.velocity.data()) = moved.translation() / kStep_s;
  Eigen::Map<Eigen::Vector3d>(result.velocity.data() + 3) = turn.angle() / kStep_s * turn.axis();
  result.velocity_covariance = arrayOf(someCovariance<6>(0.1));
  const auto motion = VehicleFrame(kMounting, 1).motion(result);
  constexpr double kTolerance = 1e-4;  // of a forward difference: half the step times the acceleration, and rounding
  EXPECT_LT((eigen(motion.velocity) - twist).cwiseAbs().maxCoeff(), kTolerance);
}

TEST(VehicleFrame, TheCovarianceOfTheVehiclesMotionIsThatOfALinearFunctionOfTheCameras) {
  const VehicleFrame frame(kMounting, 1);
  Result result;
  result.velocity_covariance = arrayOf(someCovariance<6>(0.1));
  Eigen::Matrix<double, 6, 6> J;
  for (int i = 0; i < 6; ++i) {
    result.velocity = {};
    result.velocity[static_cast<std::size_t>(i)] = 1;
    J.col(i) = eigen(frame.motion(result).velocity);
  }
  const Covariance C(result.velocity_covariance.data());
  EXPECT_TRUE(eigen(frame.motion(result).covariance).isApprox(J * C * J.transpose()));
}

TEST(VehicleFrame, AMarginMultipliesStandardDeviations) {
  const Seen seen = someSeenObject();
  const VehicleObject plain = VehicleFrame(kMounting, 1).object(seen.result, seen.object);
  const VehicleObject wide = VehicleFrame(kMounting, 3).object(seen.result, seen.object);
  EXPECT_TRUE(eigen(*wide.pose_covariance).isApprox(9 * eigen(*plain.pose_covariance)));
  EXPECT_TRUE(eigen(wide.velocity_covariance).isApprox(9 * eigen(plain.velocity_covariance)));
  EXPECT_TRUE(eigen(*wide.box->center_covariance).isApprox(9 * eigen(*plain.box->center_covariance)));
}

TEST(VehicleFrame, WhatIsNotKnownIsLeftOut) {
  Seen seen = someSeenObject();
  seen.object.covariance.reset();
  const VehicleFrame frame(kMounting, 1);
  EXPECT_FALSE(frame.object(seen.result, seen.object).pose_covariance);
  EXPECT_FALSE(frame.object(seen.result, seen.object).box->center_covariance);
  seen.object.box_size_m = {};
  EXPECT_FALSE(frame.object(seen.result, seen.object).box);
}

}  // namespace
}  // namespace vehicle_stack
