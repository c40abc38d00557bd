#include "backend/joint/noise_level.hpp"

#include <gtest/gtest.h>

#include "core/robust_loss.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

/// Residuals of Gaussian noise that is `truth` times what the front-end claims, weighted as a landmark's by a level.
ResidualLevels levelsOf(double truth, const NoiseLevel& level, test::Noise& noise) {
  const LandmarkNoise landmark;
  ResidualLevels levels;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d r = truth * Eigen::Vector3d(noise.gaussian() / level.uv(), noise.gaussian() / level.uv(),
                                                      noise.gaussian() / level.d());
    const double weight = robustWeight(landmark.loss, r.norm(), landmark.loss_scale);
    levels.uv_sum += weight * r.head<2>().squaredNorm();
    levels.d_sum += weight * r.z() * r.z();
    levels.uv_count += 2;
    levels.d_count += 1;
  }
  return levels;
}

TEST(NoiseLevel, FindsTheNoise) {
  for (const double truth : {0.5, 1.0, 2.0}) {
    test::Noise noise(1);
    NoiseLevel level;
    for (int i = 0; i < 40; ++i) level.learn(levelsOf(truth, level, noise));
    EXPECT_NEAR(level.uv(), truth, 0.06 * truth);
    EXPECT_NEAR(level.d(), truth, 0.06 * truth);
  }
}

TEST(NoiseLevel, SeesWhatResidualsHaveInCommon) {
  constexpr double kNeighbors = 50;
  const auto effectOf = [](double neighbor_sum, double successive_sum) {
    NoiseLevel level;
    for (int i = 0; i < 40; ++i)
      level.learn({.uv_sum = 2000,
                   .uv_count = 2000,
                   .d_sum = 1000,
                   .d_count = 1000,
                   .successive_sum = successive_sum,
                   .neighbor_sum = neighbor_sum,
                   .neighbor_count = 20000,
                   .views = 1000});
    return level.designEffect(kNeighbors);
  };
  EXPECT_DOUBLE_EQ(effectOf(-100, -100), 1);
  EXPECT_NEAR(effectOf(0.06 * 20000 * 3, 0), 1 + 0.06 * kNeighbors, 0.3);
  EXPECT_NEAR(effectOf(0, 1200), 1.4 / 0.6, 0.07);
}

TEST(NoiseLevel, OfAnotherBodyBeginsAsThatOfTheImageAndLearnsItsOwn) {
  test::Noise noise(1);
  NoiseLevel world;
  for (int i = 0; i < 40; ++i) world.learn(levelsOf(0.5, world, noise));
  NoiseLevel body = NoiseLevel::like(world);
  EXPECT_DOUBLE_EQ(body.uv(), world.uv());
  EXPECT_DOUBLE_EQ(body.d(), world.d());
  for (int i = 0; i < 40; ++i) body.learn(levelsOf(1.5, body, noise));
  EXPECT_NEAR(body.uv(), 1.5, 0.1);
  EXPECT_NEAR(body.d(), 1.5, 0.1);
}

TEST(NoiseLevel, BeginsAsClaimed) {
  EXPECT_DOUBLE_EQ(NoiseLevel{}.uv(), 1);
  EXPECT_DOUBLE_EQ(NoiseLevel{}.d(), 1);
  EXPECT_DOUBLE_EQ(NoiseLevel{}.designEffect(100), 1);
}

}  // namespace
}  // namespace motorcade
