#include "backend/graph/relative_pose_factor.hpp"

#include <memory>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/graph/held_end_factor.hpp"
#include "tests/backend/factor_differences.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::Noise;
using test::numericJacobian;

constexpr VariableId kI{0}, kJ{1};
constexpr double kTol = 1e-5;  // of central differences with a step of 1e-6, on whitened residuals of up to a hundred
constexpr double kFactorRounding = 1e-9;  // of some dozen operations on numbers of up to a thousand

/// Checks Jacobians against finite differences, both residuals against each other, the cost against e^T Omega e.
void checkFactor(const JacobianFactor& factor, const std::vector<Value>& values, const Eigen::VectorXd& e,
                 const Eigen::MatrixXd& information) {
  std::vector<const Value*> pointers;
  for (const Value& value : values) pointers.push_back(&value);
  const int columns = dimension(values.front()) * static_cast<int>(values.size());
  Eigen::MatrixXd term = Eigen::MatrixXd::Constant(factor.rows(), columns + 1, 1e30);  // every entry must be written
  factor.linearize(pointers, term);
  Eigen::VectorXd r(factor.rows());
  factor.residual(pointers, r);
  EXPECT_THAT(term.leftCols(columns), IsNear(numericJacobian(factor, values), kTol));
  EXPECT_THAT(term.col(columns), IsNear(r, kFactorRounding));
  const double cost = e.dot(information * e);
  EXPECT_NEAR(r.squaredNorm(), cost, kFactorRounding * (1 + cost));
}

Vector6d randomTwist(Noise& noise, double angle_rad) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = noise.gaussian();
  xi.tail<3>() *= angle_rad / xi.tail<3>().norm();
  return xi;
}

void checkInSpace(Noise& noise, double residual_angle_rad) {
  const SE3 Xi = SE3::exp(randomTwist(noise, 1.3)), Xj = SE3::exp(randomTwist(noise, 2.9));
  const SE3 E = SE3::exp(randomTwist(noise, residual_angle_rad));
  const SE3 Z = Xi.inverse() * Xj * E.inverse();
  const Matrix6d information = test::randomCovariance<6>(noise, Vector6d::Constant(2.0));
  Vector6d e;
  e << E.translation(), logSO3(E.rotation());
  checkFactor(RelativePoseFactorSE3(kI, kJ, Z, information), {Xi, Xj}, e, information);
}

TEST(RelativePoseFactorSE3, MatchesFiniteDifferencesAndTheCostOfItsDefinition) {
  Noise noise(1);
  for (int i = 0; i < 30; ++i) checkInSpace(noise, 0.3);
}

TEST(RelativePoseFactorSE3, HoldsForResidualsFromNothingToAlmostHalfATurn) {
  Noise noise(2);
  for (const double angle_rad : {1e-12, 1e-6, 1.9e-4, 2.1e-4, 1e-2, 2.0, 3.0, 3.14}) checkInSpace(noise, angle_rad);
}

TEST(RelativePoseFactorSE3, VanishesWhereTheMeasurementIsMet) {
  Noise noise(3);
  const SE3 Xi = SE3::exp(randomTwist(noise, 2.0)), Z = SE3::exp(randomTwist(noise, 3.0));
  const Matrix6d information = test::randomCovariance<6>(noise, Vector6d::Constant(2.0));
  checkFactor(RelativePoseFactorSE3(kI, kJ, Z, information), {Xi, Xi * Z}, Vector6d::Zero(), information);
}

void checkInPlane(Noise& noise, double angle_i_rad, double angle_j_rad, double residual_rad) {
  const SE2 Xi(angle_i_rad, {noise.gaussian(), noise.gaussian()}),
      Xj(angle_j_rad, {noise.gaussian(), noise.gaussian()});
  const SE2 E(residual_rad, {noise.gaussian(), noise.gaussian()});
  const SE2 Z = Xi.inverse() * Xj * E.inverse();
  const Eigen::Matrix3d information = test::randomCovariance<3>(noise, Eigen::Vector3d::Constant(2.0));
  const Eigen::Vector3d e(E.translation().x(), E.translation().y(), E.angle_rad());
  checkFactor(RelativePoseFactorSE2(kI, kJ, Z, information), {Xi, Xj}, e, information);
}

TEST(RelativePoseFactorSE2, MatchesFiniteDifferencesAndTheCostOfItsDefinition) {
  Noise noise(4);
  for (int i = 0; i < 30; ++i) checkInPlane(noise, noise.uniform(-3, 3), noise.uniform(-3, 3), noise.uniform(-1, 1));
}

TEST(RelativePoseFactorSE2, WrapsTheAngleOfItsResidual) {
  Noise noise(5);
  for (const double residual_rad : {-3.14, -2.0, 0.0, 2.0, 3.14}) {
    checkInPlane(noise, 3.1, -3.1, residual_rad);
    checkInPlane(noise, -3.1, 3.1, residual_rad);
  }
}

/// Tests information of any rank, its parts of any units: no root of Cholesky's may be there.
TEST(RelativePoseFactorSE3, TakesInformationThatLeavesDirectionsOpen) {
  Noise noise(9);
  for (int rank = 0; rank < 6; ++rank) {
    const SE3 Xi = SE3::exp(randomTwist(noise, 1.3)), Xj = SE3::exp(randomTwist(noise, 2.9));
    const SE3 E = SE3::exp(randomTwist(noise, 0.3));
    Eigen::MatrixXd rows(rank, 6);
    for (int i = 0; i < rows.size(); ++i) rows.data()[i] = noise.gaussian();
    Vector6d units;
    units << 1, 1, 1, 20, 20, 20;
    const Matrix6d information = units.asDiagonal() * (rows.transpose() * rows) * units.asDiagonal();
    Vector6d e;
    e << E.translation(), logSO3(E.rotation());
    checkFactor(RelativePoseFactorSE3(kI, kJ, Xi.inverse() * Xj * E.inverse(), information), {Xi, Xj}, e, information);
  }
}

TEST(RelativePoseFactorSE2, TakesInformationThatLeavesDirectionsOpen) {
  const SE2 Xi(0.4, {1, 2}), Xj(1.1, {3, -1}), E(0.2, {0.3, -0.5});
  const Eigen::Vector3d e(0.3, -0.5, 0.2), row(3, -1, 200);
  for (const Eigen::Matrix3d& information :
       {Eigen::Matrix3d(Eigen::Vector3d(100, 100, 0).asDiagonal()),
        Eigen::Matrix3d(Eigen::Vector3d(0, 0, 4).asDiagonal()), Eigen::Matrix3d(row * row.transpose()),
        Eigen::Matrix3d(Eigen::Matrix3d::Zero()), Eigen::Matrix3d(Eigen::Vector3d(1e4, 0, 1e-3).asDiagonal())})
    checkFactor(RelativePoseFactorSE2(kI, kJ, Xi.inverse() * Xj * E.inverse(), information), {Xi, Xj}, e, information);
}

TEST(HeldEndFactor, IsTheFactorOnWhatIsLeft) {
  Noise noise(4);
  const SE3 Xi = SE3::exp(randomTwist(noise, 1.3)), Xj = SE3::exp(randomTwist(noise, 0.9));
  const SE3 E = SE3::exp(randomTwist(noise, 0.3)), Z = Xi.inverse() * Xj * E.inverse();
  const Matrix6d information = test::randomCovariance<6>(noise, Vector6d::Constant(2.0));
  Vector6d e;
  e << E.translation(), logSO3(E.rotation());
  const auto whole = [&] { return std::make_unique<RelativePoseFactorSE3>(kI, kJ, Z, information); };
  checkFactor(HeldEndFactor(whole(), HeldEndFactor::Held::kFirst, Xi, kJ), {Xj}, e, information);
  checkFactor(HeldEndFactor(whole(), HeldEndFactor::Held::kSecond, Xj, kI), {Xi}, e, information);
  const HeldEndFactor factor(whole(), HeldEndFactor::Held::kFirst, Xi, kJ);
  ASSERT_EQ(factor.variables().size(), 1U);
  EXPECT_EQ(factor.variables()[0], kJ);
}

TEST(PriorFactorSE2, MatchesFiniteDifferencesAndTheCostOfItsDefinition) {
  Noise noise(6);
  for (int i = 0; i < 10; ++i) {
    const SE2 mean(noise.uniform(-3, 3), {noise.gaussian(), noise.gaussian()}),
        X(noise.uniform(-3, 3), {noise.gaussian(), noise.gaussian()});
    const Eigen::Matrix3d information = test::randomCovariance<3>(noise, Eigen::Vector3d::Constant(2.0));
    const SE2 E = mean.inverse() * X;
    const Eigen::Vector3d e(E.translation().x(), E.translation().y(), E.angle_rad());
    checkFactor(PriorFactorSE2(kI, mean, information), {X}, e, information);
  }
}

}  // namespace
}  // namespace motorcade
