#include "backend/graph/variable.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/backend/perturbation.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::local;
using test::Noise;
using test::retract;

constexpr double kValueRounding = 1e-12;  // of a few operations on numbers of order one

SmallVector randomVector(Noise& noise, int size, double sigma) {
  SmallVector v(size);
  for (double& x : v) x = noise.gaussian(sigma);
  return v;
}

/// One of each kind, the planar ones turned by any angle.
std::vector<Value> randomValues(Noise& noise) {
  std::vector<Value> values{SE3::exp(randomVector(noise, 6, 1)),
                            SE2(noise.uniform(-3.2, 3.2), randomVector(noise, 2, 1))};
  for (int size = 1; size <= 6; ++size) values.emplace_back(randomVector(noise, size, 1));
  return values;
}

double difference(const Value& a, const Value& b) {
  if (const auto* pose = std::get_if<SE3>(&a)) {
    const auto& other = std::get<SE3>(b);
    return std::max((pose->rotation() - other.rotation()).norm(), (pose->translation() - other.translation()).norm());
  }
  if (const auto* planar = std::get_if<SE2>(&a)) {
    const auto& other = std::get<SE2>(b);
    return std::max((planar->rotation() - other.rotation()).norm(),
                    (planar->translation() - other.translation()).norm());
  }
  return (std::get<SmallVector>(a) - std::get<SmallVector>(b)).norm();
}

TEST(Variable, RetractAndLocalAreInverse) {
  Noise noise(1);
  for (int i = 0; i < 50; ++i) {
    const auto from = randomValues(noise), to = randomValues(noise);
    for (std::size_t k = 0; k < from.size(); ++k) {
      EXPECT_LT(difference(retract(from[k], local(from[k], to[k])), to[k]), kValueRounding);
      const SmallVector delta = randomVector(noise, dimension(from[k]), 0.5);
      EXPECT_THAT(local(from[k], retract(from[k], delta)), IsNear(delta, kValueRounding));
    }
  }
}

TEST(Variable, DisplacedAndDisplacementAreInverse) {
  Noise noise(2);
  for (int i = 0; i < 50; ++i) {
    const auto from = randomValues(noise), to = randomValues(noise);
    for (std::size_t k = 0; k < from.size(); ++k) {
      EXPECT_LT(difference(displaced(from[k], displacement(from[k], to[k])), to[k]), kValueRounding);
      const SmallVector step = randomVector(noise, dimension(from[k]), 0.5);  // turns by less than half a turn
      EXPECT_THAT(displacement(from[k], displaced(from[k], step)), IsNear(step, kValueRounding));
    }
  }
}

TEST(Variable, AStepIsInTheWorldsAxesAndTurnsAPoseAboutItsOrigin) {
  const SE3 pose(expSO3({0.3, -0.5, 1.2}), {4, 5, 6});
  SmallVector step(6);
  step << 1, 2, 3, 0, 0, std::numbers::pi / 2;
  const auto moved = std::get<SE3>(displaced(pose, step));
  EXPECT_THAT(moved.translation(), IsNear(Eigen::Vector3d(5, 7, 9), kValueRounding));
  const Eigen::Vector3d ahead = pose.rotation().col(0);  // turned about the world's z axis
  EXPECT_THAT(moved.rotation().col(0), IsNear(Eigen::Vector3d(-ahead.y(), ahead.x(), ahead.z()), kValueRounding));

  const SE2 planar(0.4, {1, 2});
  const auto moved_planar = std::get<SE2>(displaced(planar, Eigen::Vector3d(3, 4, 0.5)));
  EXPECT_THAT(moved_planar.translation(), IsNear(Eigen::Vector2d(4, 6), kValueRounding));
  EXPECT_NEAR(moved_planar.angle_rad(), 0.9, kValueRounding);
}

TEST(Variable, ADisplacementInThePlaneTakesTheShortWayRound) {
  const SmallVector step = displacement(SE2(3.1, {0, 0}), SE2(-3.1, {0, 0}));
  EXPECT_NEAR(step[2], 2 * std::numbers::pi - 6.2, kValueRounding);
}

/// Many small steps must not take a rotation off SO(3).
TEST(Variable, StepsKeepARotationARotation) {
  Noise noise(3);
  Value by_delta = SE3{}, by_step = SE3{};
  for (int i = 0; i < 20000; ++i) {
    const SmallVector move = randomVector(noise, 6, 0.1);
    by_delta = retract(by_delta, move);
    by_step = displaced(by_step, move);
  }
  for (const Value& value : {by_delta, by_step}) {
    const auto& R = std::get<SE3>(value).rotation();
    EXPECT_THAT(R * R.transpose(), IsNear(Eigen::Matrix3d::Identity(), 1e-14));
  }
}

}  // namespace
}  // namespace motorcade
