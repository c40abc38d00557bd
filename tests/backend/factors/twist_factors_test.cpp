#include "backend/factors/twist_factors.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/backend/factor_differences.hpp"
#include "tests/backend/random_graphs.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::numericJacobian;
using test::pointersTo;
using test::RandomPoses;
using test::residualAt;

constexpr double kDt_s = 0.1;
const Vector6d kDensity = (Vector6d() << 2, 0.3, 0.1, 0.01, 0.01, 0.05).finished();

void expectJacobianOfResidual(const JacobianFactor& factor, const std::vector<Value>& values) {
  const Eigen::MatrixXd numeric = numericJacobian(factor, values);
  Eigen::MatrixXd term(factor.rows(), numeric.cols() + 1);
  factor.linearize(pointersTo(values), term);
  const double scale = numeric.cwiseAbs().maxCoeff();
  EXPECT_THAT(Eigen::MatrixXd(term.leftCols(numeric.cols()) / scale), IsNear(Eigen::MatrixXd(numeric / scale), 1e-5));
  EXPECT_THAT(Eigen::VectorXd(term.rightCols<1>()), IsNear(residualAt(factor, values), 1e-9));
}

/// A vehicle on an arc of constant twist, seen from a moving camera: (c_a, w, c_b, w, x_a, x_b).
std::vector<Value> arc(RandomPoses& random) {
  Vector6d w;
  w << 12, 0.2, 0.1, 0.02, 0.01, 0.3;
  const SE3 T_a = random.pose(10, 0.5), T_b = T_a * SE3::exp(kDt_s * w);
  const SE3 x_a = random.pose(5, 0.3), x_b = x_a * random.pose(1, 0.1);
  return {x_a.inverse() * T_a, SmallVector(w), x_b.inverse() * T_b, SmallVector(w), x_a, x_b};
}

ConstantTwistFactor::Variables variables(bool with_camera) {
  ConstantTwistFactor::Variables v{.c_a = {0}, .w_a = {1}, .c_b = {2}, .w_b = {3}, .x_a = {}, .x_b = {}};
  if (with_camera) v.x_a = {4}, v.x_b = {5};
  return v;
}

TEST(ConstantTwistFactor, HasNoResidualOnAnArc) {
  RandomPoses random(1);
  const std::vector<Value> values = arc(random);
  const ConstantTwistFactor factor(variables(true), SE3{}, kDt_s, kDensity);
  EXPECT_LT(residualAt(factor, values).norm(), 1e-6);
}

TEST(ConstantTwistFactor, JacobianMatchesFiniteDifferences) {
  RandomPoses random(2);
  for (int i = 0; i < 10; ++i) {
    std::vector<Value> values = arc(random);
    values[2] = std::get<SE3>(values[2]) * random.pose(0.05, 0.01);
    expectJacobianOfResidual(ConstantTwistFactor(variables(true), SE3{}, kDt_s, kDensity), values);
    const SE3 u = std::get<SE3>(values[4]).inverse() * std::get<SE3>(values[5]);
    values.resize(4);
    expectJacobianOfResidual(ConstantTwistFactor(variables(false), u, kDt_s, kDensity), values);
  }
}

/// A change of the twist by one standard deviation of the integrated noise, (dt^3/3, dt^2/2; dt^2/2, dt), costs one.
TEST(ConstantTwistFactor, WhitensByTheIntegratedNoise) {
  const ConstantTwistFactor factor(variables(false), SE3{}, kDt_s, kDensity);
  Eigen::Matrix2d Q;
  Q << kDt_s * kDt_s * kDt_s / 3, kDt_s * kDt_s / 2, kDt_s * kDt_s / 2, kDt_s;
  const Eigen::Vector2d error(0.02, 0.3);  // of position and velocity along the second axis
  Vector6d moved = Vector6d::Zero(), changed = Vector6d::Zero();
  moved[1] = error[0], changed[1] = error[1];
  const std::vector<Value> values{SE3{}, SmallVector(Vector6d::Zero()), SE3::exp(moved), SmallVector(changed)};
  EXPECT_NEAR(residualAt(factor, values).squaredNorm(), error.dot(Q.inverse() * error) / kDensity[1], 1e-6);
}

/// Noise along the axes of travel is that along the body's of the same motion in axes that are turned.
TEST(ConstantTwistFactor, TakesTheNoiseAlongTheAxesOfTravel) {
  RandomPoses random(3);
  std::vector<Value> values = arc(random);
  values.resize(4);
  values[2] = std::get<SE3>(values[2]) * random.pose(0.05, 0.01);
  const SE3 turn(travelAxes(Eigen::Vector3d(0, 0.4, -0.2)), Eigen::Vector3d::Zero());
  std::vector<Value> turned = values;
  for (const int k : {0, 2}) turned[k] = std::get<SE3>(values[k]) * turn;
  for (const int k : {1, 3}) turned[k] = SmallVector(turn.inverse().adjoint() * std::get<SmallVector>(values[k]));
  const ConstantTwistFactor plain(variables(false), SE3{}, kDt_s, kDensity),
      along_travel(variables(false), SE3{}, kDt_s, kDensity, turn.rotation());
  EXPECT_THAT(residualAt(along_travel, values), IsNear(residualAt(plain, turned), 1e-6));
  EXPECT_GT((residualAt(plain, values) - residualAt(plain, turned)).norm(), 1);
  expectJacobianOfResidual(along_travel, values);
}

TEST(RollingFactor, JacobianMatchesFiniteDifferences) {
  const RollingFactor factor({0}, {1}, {});
  expectJacobianOfResidual(factor, {SmallVector((Vector6d() << 9, 0.4, 0.1, 0.05, 0.1, 0.3).finished()),
                                    SmallVector(Eigen::Vector3d(1.3, 0.2, -0.1))});
}

TEST(RollingFactor, HasNoResidualWhereTheRearAxleDoesNotSlip) {
  const double lever_m = 1.5, turn_radps = 0.4;
  Vector6d along_travel = Vector6d::Zero();
  along_travel[0] = 8, along_travel[5] = turn_radps, along_travel[1] = lever_m * turn_radps;
  const RollingFactor factor({0}, {1}, {});
  const Eigen::Vector3d travel(lever_m, 0.3, -0.05);
  const Eigen::Matrix3d R = travelAxes(travel);
  Vector6d w;
  w << R * along_travel.head<3>(), R * along_travel.tail<3>();
  EXPECT_LT(residualAt(factor, {SmallVector(w), SmallVector(travel)}).norm(), 1e-12);
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d other = travel;
    other[k] *= -1;
    EXPECT_GT(residualAt(factor, {SmallVector(w), SmallVector(other)}).norm(), 1) << k;
  }
}

TEST(VectorPriorFactor, CountsInStandardDeviations) {
  const VectorPriorFactor factor({0}, SmallVector::Constant(2, 1.0), SmallVector::Constant(2, 0.5));
  const std::vector<Value> values{SmallVector(SmallVector::Constant(2, 2.0))};
  EXPECT_THAT(residualAt(factor, values), IsNear(Eigen::VectorXd(Eigen::VectorXd::Constant(2, 2.0)), 1e-12));
  expectJacobianOfResidual(factor, values);
}

}  // namespace
}  // namespace motorcade
