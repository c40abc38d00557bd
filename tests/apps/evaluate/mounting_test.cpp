#include "apps/evaluate/comparison/mounting.hpp"

#include <random>

#include <gtest/gtest.h>

#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

/// A drive of 150 steps of about a meter that turns left and right, up and down.
std::vector<SE3> windingDrive() {
  std::vector<SE3> poses(1);
  for (int i = 1; i < 150; ++i) {
    const Eigen::Vector3d turn_rad(0.01 * std::cos(0.1 * i), 0.04 * std::sin(0.07 * i), 0.01 * std::sin(0.13 * i));
    poses.push_back((poses.back() * SE3(expSO3(turn_rad), {0, 0, 1})).normalized());
  }
  return poses;
}

const SE3 kT_true_cam(expSO3({0.004, -0.013, 0.006}), {0.3, -0.2, -0.6});

/// Truth with this mounting along a camera's path.
std::vector<SE3> truthOf(const std::vector<SE3>& cameras) { return withMounting(cameras, kT_true_cam.inverse()); }

TEST(Mounting, IsFoundWithoutNoiseUpToItsPrior) {
  const auto cameras = windingDrive();
  const SE3 X = fitMounting(cameras, truthOf(cameras));
  const Vector6d error = (X.inverse() * kT_true_cam).log();
  EXPECT_LT(error.tail<3>().norm(), 1e-4);  // rad
  EXPECT_LT(error.head<3>().norm(), 0.02);  // m: of .7 m, the prior of 1 m pulls a little
  const auto before = trajectoryErrors(cameras, truthOf(cameras)),
             after = trajectoryErrors(cameras, withMounting(truthOf(cameras), X));
  EXPECT_GT(before->end_percent, 0.5);
  EXPECT_LT(after->end_percent, 0.02);
  EXPECT_LT(after->rpe_m.rmse, 0.05 * before->rpe_m.rmse);
}

TEST(Mounting, IsFoundThroughNoiseWithinWhatTheNoiseAllows) {
  std::mt19937 generator(4);
  std::normal_distribution<double> noise;
  const auto cameras = windingDrive();
  std::vector<SE3> estimate(1), truth = truthOf(cameras);
  const auto noisy = [&](const SE3& motion, double sigma_m, double sigma_rad) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? sigma_m : sigma_rad) * noise(generator);
    return motion * SE3::exp(xi);
  };
  for (std::size_t i = 1; i < cameras.size(); ++i)
    estimate.push_back(estimate.back() * noisy(cameras[i - 1].inverse() * cameras[i], 0.005, 1e-4));
  for (SE3& pose : truth) pose = noisy(pose, 0.01, 1e-4);
  const Vector6d error = (fitMounting(estimate, truth).inverse() * kT_true_cam).log();
  // .01 m per step of 1 m in 150 steps: .001 rad; four times that.
  EXPECT_LT(error.tail<3>().norm(), 0.004);
}

TEST(Mounting, NothingIsRemovedWhereTruthAndEstimateAgreeOrTheDriveTellsNothing) {
  const auto cameras = windingDrive();
  EXPECT_LT(fitMounting(cameras, cameras).log().norm(), 1e-9);
  const SE3 one_pose = fitMounting({SE3()}, {SE3()});
  EXPECT_LT(one_pose.log().norm(), 1e-9);
  // Straight ahead, the path says nothing of the roll and of the lever arm: they stay at their prior.
  std::vector<SE3> straight, turned;
  for (int i = 0; i < 50; ++i) straight.emplace_back(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, i));
  for (const SE3& pose : straight) turned.push_back(pose * SE3(expSO3({0.01, 0.02, 0}), {0, 0, 0}));
  const SE3 X = fitMounting(straight, turned);
  EXPECT_LT((logSO3(X.rotation()) - Eigen::Vector3d(-0.01, -0.02, 0)).norm(), 2e-4);
  EXPECT_LT(X.translation().norm(), 1e-3);
}

}  // namespace
}  // namespace motorcade
