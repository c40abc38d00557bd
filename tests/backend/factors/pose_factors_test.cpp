#include "backend/factors/pose_factors.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "backend/graph/marginal_factor.hpp"
#include "tests/backend/random_graphs.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::numericJacobian;
using test::RandomPoses;

constexpr double kTol = 1e-5;  // central differences with a step of 1e-6 on residuals of up to ten

template <std::size_t N, class Model>
void checkJacobians(const Model& model, std::array<SE3, N> poses) {
  const auto analytic = model.evaluate(poses);
  for (std::size_t k = 0; k < N; ++k) {
    const auto residual = [&](const SE3& T) {
      auto moved = poses;
      moved[k] = T;
      return model.evaluate(moved).residual;
    };
    EXPECT_THAT(analytic.J[k], IsNear(numericJacobian(residual, poses[k]), kTol)) << "variable " << k;
  }
}

template <std::size_t N>
std::array<SE3, N> randomPoses(RandomPoses& random) {
  std::array<SE3, N> poses;
  for (SE3& T : poses) T = random.pose(2.0, 0.7);
  return poses;
}

TEST(PriorModel, JacobianMatchesFiniteDifferences) {
  RandomPoses random(1);
  for (int i = 0; i < 20; ++i) checkJacobians<1>(PriorModel{random.pose(1, 0.5)}, randomPoses<1>(random));
}

TEST(MotionModel, JacobiansMatchFiniteDifferences) {
  RandomPoses random(2);
  for (int i = 0; i < 20; ++i) checkJacobians<2>(MotionModel{random.pose(1, 0.5)}, randomPoses<2>(random));
}

TEST(CameraEncounterModel, JacobiansMatchFiniteDifferences) {
  RandomPoses random(3);
  for (int i = 0; i < 20; ++i) checkJacobians<3>(CameraEncounterModel{random.pose(1, 0.5)}, randomPoses<3>(random));
}

TEST(ObjectEncounterModel, JacobiansMatchFiniteDifferences) {
  RandomPoses random(4);
  for (int i = 0; i < 20; ++i) {
    const auto poses = randomPoses<4>(random);
    // Near the truth, so that the residual's angle stays away from pi.
    const SE3 T_m_n = (poses[0] * poses[1]).inverse() * poses[2] * poses[3] * random.pose(1, 0.3);
    checkJacobians<4>(ObjectEncounterModel{T_m_n}, poses);
  }
}

TEST(SmoothMotionModel, JacobiansMatchFiniteDifferences) {
  RandomPoses random(5);
  for (int i = 0; i < 20; ++i) {
    std::array<SE3, 3> z{random.pose(2, 0.7)};
    z[1] = z[0] * random.pose(1, 0.3);
    z[2] = z[1] * random.pose(1, 0.3);
    checkJacobians<3>(SmoothMotionModel{0.5, 0.8}, z);
  }
}

TEST(SmoothMotionModel, IsZeroOnAnArcWithUnevenFrames) {
  Vector6d twist;
  twist << 9, 0, 0, 0, 0, 0.3;
  const std::array<SE3, 3> z{SE3{}, SE3::exp(0.1 * twist), SE3::exp(0.4 * twist)};
  EXPECT_LT((SmoothMotionModel{0.1, 0.3}.evaluate(z).residual.norm()), 1e-9);
}

TEST(SmoothMotionNoise, GrowsWithTheTimeBetweenFrames) {
  const AccelerationNoise acceleration{2, 0.5, 0.3, 0.3, 0.1};
  const auto short_step = smoothMotionNoise(acceleration, 0.1, 0.1),
             long_step = smoothMotionNoise(acceleration, 0.4, 0.4);
  EXPECT_NEAR(short_step.sqrt_information(0, 0), 2 * long_step.sqrt_information(0, 0), 1e-12);
  EXPECT_NEAR(1 / short_step.sqrt_information(0, 0), 2 * std::sqrt(0.1), 1e-12);
  EXPECT_NEAR(1 / short_step.sqrt_information(5, 5), 0.3 * std::sqrt(0.1), 1e-12);
}

TEST(EncounterResiduals, VanishAtTheMeasuredPoses) {
  RandomPoses random(6);
  const auto p = randomPoses<4>(random);
  EXPECT_LT((CameraEncounterModel{p[0].inverse() * p[1] * p[2]}.evaluate({p[0], p[1], p[2]}).residual.norm()), 1e-12);
  EXPECT_LT((ObjectEncounterModel{(p[0] * p[1]).inverse() * p[2] * p[3]}.evaluate(p).residual.norm()), 1e-12);
}

TEST(PoseFactor, RobustLossWeightsTheWhitenedResidual) {
  const PoseNoise plain = test::isotropicNoise(0.1, 0.1);
  PoseNoise huber = plain;
  huber.loss = RobustLoss::kHuber;
  huber.loss_scale = 2.0;
  const Value far = SE3(Eigen::Matrix3d::Identity(), {0.8, 0, 0});  // 8 sigma
  const std::array values{&far};
  Eigen::MatrixXd full(6, 7), weighted(6, 7);
  PriorFactor({VariableId{0}}, PriorModel{}, plain).linearize(values, full);
  PriorFactor({VariableId{0}}, PriorModel{}, huber).linearize(values, weighted);
  EXPECT_THAT(weighted, IsNear((0.5 * full).eval(), 1e-12));  // weight 2/8, applied to the square
}

TEST(MarginalFactor, KeepsItsQuadraticWhenTheLinearizationPointMoves) {
  RandomPoses random(7);
  const SE3 then = random.pose(1, 0.5), now = then * random.pose(0.1, 0.05);
  const Eigen::Matrix<double, 7, 7> root = Eigen::Matrix<double, 7, 7>::Random();
  const Eigen::MatrixXd information = root.transpose() * root;
  const MarginalFactor factor({VariableId{0}}, {then}, information);  // of a step in the world's axes
  const auto cost = [&](const SE3& T) {
    Eigen::Matrix<double, 7, 1> e;
    e << displacement(then, T), 1;
    return e.dot(information * e);
  };
  const Value value = now;
  Eigen::MatrixXd term(7, 7);
  factor.linearize(std::array{&value}, term);
  EXPECT_NEAR(term(6, 6), cost(now), 1e-12);
  for (int i = 0; i < 6; ++i) {
    Vector6d step = Vector6d::Zero();
    step[i] = 1e-6;
    const auto stepped = [&](double sign) { return std::get<SE3>(displaced(now, sign * step)); };
    EXPECT_NEAR(2 * term(6, i), (cost(stepped(1)) - cost(stepped(-1))) / 2e-6, 1e-6);
  }
}

TEST(SquareRootInformation, IsEmptyForAnUnusableCovariance) {
  EXPECT_FALSE(squareRootInformation(-Matrix6d::Identity()));
  EXPECT_FALSE(squareRootInformation(Matrix6d::Constant(std::nan(""))));
  EXPECT_TRUE(squareRootInformation(Matrix6d::Identity()));
}

}  // namespace
}  // namespace motorcade
