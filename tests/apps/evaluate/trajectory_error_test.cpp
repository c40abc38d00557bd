#include "apps/evaluate/comparison/trajectory_error.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

/// A straight drive with a pose every `step_m`.
std::vector<SE3> straight(double length_m, double step_m) {
  std::vector<SE3> path;
  for (int i = 0; i * step_m <= length_m + 1e-9; ++i)
    path.emplace_back(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, i * step_m));
  return path;
}

/// The same poses along the true path, with its scale and heading wrong: steps are `scale` times as long, and each
/// turns by `turn_rad` to the side.
std::vector<SE3> drifting(const std::vector<SE3>& truth, double scale, double turn_rad) {
  std::vector<SE3> path{SE3()};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const SE3 step = truth[i - 1].inverse() * truth[i];
    path.push_back(path.back() * SE3(step.rotation() * expSO3({0, turn_rad, 0}), scale * step.translation()));
  }
  return path;
}

TEST(SegmentErrors, AnErrorOfScaleIsTheSameShareOfEachLength) {
  constexpr double kStep_m = 0.8;  // no multiple of it is a segment's length: segments end a little farther on
  const auto truth = straight(1000, kStep_m);
  const auto errors = segmentErrors(drifting(truth, 1.02, 0), truth);
  ASSERT_TRUE(errors);
  EXPECT_FALSE(errors->short_segments);
  std::size_t segments = 0;
  double sum_percent = 0;
  for (std::size_t k = 0; k < SegmentErrors::kLengths; ++k) {
    const auto& of_length = errors->by_length[k];
    const double length_m = 100.0 * static_cast<double>(k + 1);
    EXPECT_EQ(of_length.length_m, length_m);
    const double way_m = kStep_m * (std::floor(length_m / kStep_m + 1e-9) + 1);  // to the first frame beyond it
    const auto last_start = static_cast<std::size_t>(std::lround((1000 - way_m) / kStep_m - 0.4));
    EXPECT_EQ(of_length.segments, last_start / 10 + 1) << length_m;
    EXPECT_NEAR(of_length.translation_percent, 2 * way_m / length_m, 1e-9) << length_m;
    EXPECT_NEAR(of_length.rotation_deg_per_m, 0, 1e-9);
    segments += of_length.segments;
    sum_percent += static_cast<double>(of_length.segments) * of_length.translation_percent;
  }
  EXPECT_EQ(errors->all.segments, segments);
  EXPECT_NEAR(errors->all.translation_percent, sum_percent / static_cast<double>(segments), 1e-9)
      << "each segment counts once, whatever its length";
}

TEST(SegmentErrors, ADriftOfHeadingTurnsEachSegmentAndBendsIt) {
  constexpr double kStep_m = 0.7, kTurnPerMeter_rad = 1e-4;
  const auto truth = straight(420, kStep_m);
  const auto errors = segmentErrors(drifting(truth, 1, kTurnPerMeter_rad * kStep_m), truth);
  ASSERT_TRUE(errors);
  const auto& shortest = errors->by_length[0];
  const double way_m = kStep_m * 143;  // 100.1 m
  const double turn_rad = kTurnPerMeter_rad * way_m;
  EXPECT_NEAR(shortest.rotation_deg_per_m, turn_rad * 180 / std::numbers::pi / 100, 1e-9);
  // An arc: the end lies aside by half the turn times the way, and the way's last step has not turned yet.
  EXPECT_NEAR(shortest.translation_percent, turn_rad / 2 * way_m, 0.01 * turn_rad / 2 * way_m);
  EXPECT_EQ(errors->by_length[4].segments, 0U) << "500 m";
}

TEST(SegmentErrors, ShortDrivesHaveATenthOfTheLengths) {
  const auto truth = straight(60, 0.9);
  const auto errors = segmentErrors(drifting(truth, 0.99, 0), truth);
  ASSERT_TRUE(errors);
  EXPECT_TRUE(errors->short_segments);
  EXPECT_EQ(errors->by_length[0].length_m, 10);
  EXPECT_EQ(errors->by_length[0].segments, 6U);  // from 0, 9, ..., 45 m on; from 54 m it would end at 64.8
  EXPECT_NEAR(errors->by_length[0].translation_percent, 1.08, 1e-9);  // 10.8 m, divided by 10
  EXPECT_EQ(errors->by_length[5].segments, 0U) << "60 m are not exceeded";
  EXPECT_FALSE(segmentErrors(straight(9, 0.9), straight(9, 0.9)));
  EXPECT_FALSE(segmentErrors({}, {}));
}

TEST(SegmentErrors, DoNotDependOnWhereTheWorldIs) {
  const auto truth = straight(350, 1.1);
  auto estimate = drifting(truth, 1.01, 2e-4);
  const auto errors = segmentErrors(estimate, truth);
  const SE3 elsewhere = SE3::exp((Vector6d() << 5, -3, 40, 0.2, 1, -0.1).finished());
  for (SE3& pose : estimate) pose = elsewhere * pose;
  const auto moved = segmentErrors(estimate, truth);
  EXPECT_NEAR(errors->all.translation_percent, moved->all.translation_percent, 1e-9);
  EXPECT_NEAR(errors->all.rotation_deg_per_m, moved->all.rotation_deg_per_m, 1e-9);
}

}  // namespace
}  // namespace motorcade
