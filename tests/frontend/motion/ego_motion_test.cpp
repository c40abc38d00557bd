#include "frontend/motion/ego_motion.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::Noise;

/// A street of which a share moves as one: a truck beside us.
struct Street {
  std::vector<PoseObservation> observations;
  std::vector<bool> moves;
  std::vector<PointLabel> labels() const {
    std::vector<PointLabel> labels;
    for (const bool one : moves) labels.push_back(one ? PointLabel::kMoving : PointLabel::kUnknown);
    return labels;
  }
};

std::vector<PointLabel> nothingKnown(const Street& s) {
  return std::vector<PointLabel>(s.moves.size(), PointLabel::kUnknown);
}

SE3 trueMotion() {
  Vector6d xi;
  xi << 0.02, 0, 1.0, 0, 0.015, 0;
  return SE3::exp(xi);  // T_seen_now
}

enum class Movers { kTruckBesideUs, kEverywhere };

Street street(int at_rest, int moving, std::uint64_t seed, const SE3& T_seen_now = trueMotion(),
              Movers movers = Movers::kTruckBesideUs) {
  const Eigen::Vector3d step_m(0.15, 0, 0.9);  // of the movers: about our own way, as in traffic
  Noise noise(seed);
  Street s;
  while (static_cast<int>(s.observations.size()) < at_rest + moving) {
    const bool moves = static_cast<int>(s.observations.size()) >= at_rest;
    const bool of_truck = moves && movers == Movers::kTruckBesideUs;
    const Eigen::Vector3d before = of_truck ? noise.inBox({1, -1.5, 9}, {5, 1.2, 16}) : test::streetPoint(noise, 6, 35);
    const Eigen::Vector3d now = T_seen_now.inverse() * (moves ? Eigen::Vector3d(before + step_m) : before);
    const auto o = test::lookTwice(before, now, noise);
    if (!o) continue;
    s.observations.push_back(*o);
    s.moves.push_back(moves);
  }
  return s;
}

/// The right motion up to its own covariance, and the right inliers.
void expectTrueMotion(const std::optional<EgoMotion>& ego, const Street& s, std::uint64_t seed) {
  ASSERT_TRUE(ego) << "seed " << seed;
  const Vector6d error = (trueMotion().inverse() * ego->T_seen_now).log();
  EXPECT_LT(test::nees(error, ego->covariance), 30) << "seed " << seed;  // chi2(6) is below it but for 4 in 100,000
  int right = 0;
  for (std::size_t i = 0; i < s.moves.size(); ++i) right += ego->inliers[i] != s.moves[i];
  EXPECT_GT(right, 0.95 * static_cast<double>(s.moves.size()))
      << "seed " << seed;  // 1 % of those at rest lie beyond the gate
}

TEST(EgoMotion, SurvivesSixtyPercentMoversKnownFromBefore) {
  const EgoMotionEstimator estimate({}, kRig);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Street s = street(80, 120, seed);
    expectTrueMotion(estimate(s.observations, s.labels(), {SE3{}}, seed), s, seed);
  }
}

TEST(EgoMotion, SurvivesFortyPercentUnknownMovers) {
  const EgoMotionEstimator estimate({}, kRig);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Street s = street(120, 80, 100 + seed);
    expectTrueMotion(estimate(s.observations, nothingKnown(s), {SE3{}}, seed), s, seed);
  }
}

TEST(EgoMotion, CovarianceIsThatOfTheErrors) {
  constexpr int kSeeds = 300;
  Vector6d xi;
  xi << 1.5, 0, 3, 0, 0,
      1;  // a camera that rolls by a radian: with little rotation, perturbing either side of the motion is the same
  const SE3 T_seen_now = SE3::exp(xi);
  const EgoMotionEstimator estimate({}, kRig);
  double mean = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Street s = street(100, 0, 200 + static_cast<std::uint64_t>(seed), T_seen_now);
    const auto ego = estimate(s.observations, s.labels(), {T_seen_now}, static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(ego);
    const Vector6d error = (T_seen_now.inverse() * ego->T_seen_now).log();
    mean += test::nees(error, ego->covariance) / kSeeds;
  }
  EXPECT_NEAR(mean, 6, test::meanChi2Spread(6, kSeeds));
}

TEST(EgoMotion, TooFewPointsGiveNone) {
  const EgoMotionEstimator estimate({}, kRig);
  const Street few = street(11, 0, 1);
  EXPECT_FALSE(estimate(few.observations, few.labels(), {trueMotion()}, 1));
  EXPECT_FALSE(estimate({}, {}, {trueMotion()}, 1));
  Street scattered = street(30, 0, 2);  // enough points, of which hardly any agree
  Noise noise(3);
  for (auto& o : scattered.observations) o.uvd_px += noise.inBox({-60, -40, -5}, {60, 40, 5});
  EXPECT_FALSE(estimate(scattered.observations, scattered.labels(), {trueMotion()}, 1));
}

TEST(EgoMotion, EqualSeedsGiveEqualResults) {
  const EgoMotionEstimator estimate({}, kRig);
  const Street s = street(120, 80, 5);
  const auto first = estimate(s.observations, nothingKnown(s), {SE3{}}, 9);
  const auto second = estimate(s.observations, nothingKnown(s), {SE3{}}, 9);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->T_seen_now.translation(), second->T_seen_now.translation());  // to the last bit
  EXPECT_EQ(first->T_seen_now.rotation(), second->T_seen_now.rotation());
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST(EgoMotion, TheWorldIsLargerThanTheVehiclesThatFillTheView) {
  const EgoMotionEstimator estimate({}, kRig);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Street s = street(150, 250, seed);
    expectTrueMotion(estimate(s.observations, nothingKnown(s), {SE3{}}, seed), s, seed);
  }
}

TEST(EgoMotion, ASteadyMotionIsNotGivenUpForOneThatNoVehicleCanMake) {
  const EgoMotionEstimator estimate({}, kRig);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SE3 expected = SE3::exp(2.0 * trueMotion().log());  // much faster than the movers
    const Street s = street(100, 150, seed, expected, Movers::kEverywhere);
    const auto ego = estimate(s.observations, nothingKnown(s), {expected, 0.1, 10}, seed);
    ASSERT_TRUE(ego) << "seed " << seed;
    EXPECT_TRUE(estimate.follows(ego->T_seen_now.inverse(), {expected, 0.1, 10}));
    EXPECT_LT((ego->T_seen_now.translation() - expected.translation()).norm(), 0.1) << "seed " << seed;
  }
}

/// A truck passes ahead of a car that stands, and all that is at rest are a few points.
TEST(EgoMotion, ACarDoesNotSlideWhereATruckFillsTheView) {
  const EgoMotionEstimator estimate({}, kRig);
  const SE3 standing, sliding(Eigen::Matrix3d::Identity(), {-0.65, 0, 0});
  const Street truck = street(90, 0, 1, sliding), around = street(30, 0, 2, standing);
  Street s = truck;
  s.observations.insert(s.observations.end(), around.observations.begin(), around.observations.end());
  s.moves.resize(s.observations.size(), false);
  PredictedMotion predicted{standing, 0.1, 0, 50};
  const auto of_car = estimate(s.observations, nothingKnown(s), predicted, 1);
  ASSERT_TRUE(of_car);
  EXPECT_LT(of_car->T_seen_now.translation().norm(), 0.05);
  EXPECT_FALSE(estimate(truck.observations, nothingKnown(truck), predicted, 1));
  predicted.ahead_frames = 0;  // whatever the camera is mounted on
  const auto of_any = estimate(s.observations, nothingKnown(s), predicted, 1);
  ASSERT_TRUE(of_any);
  EXPECT_LT((of_any->T_seen_now.translation() - sliding.translation()).norm(), 0.05);
}

/// Some points of vehicles that fill the view agree with a motion that is none.
TEST(EgoMotion, AMotionOnWhichFewAgreeMustBeSteady) {
  const EgoMotionEstimator estimate({}, kRig);
  const auto believed = [&](int agreeing, double change_m, const PredictedMotion& known) {
    Street s = street(agreeing, 0, 1);
    Noise noise(2);
    while (s.observations.size() < 400) {  // each with a motion of its own
      const Eigen::Vector3d before = test::streetPoint(noise, 6, 35);
      const auto o = test::lookTwice(before, before + noise.inBox({-2, -1, -2}, {2, 1, 2}), noise);
      if (!o) continue;
      s.observations.push_back(*o);
      s.moves.push_back(true);
    }
    PredictedMotion predicted = known;
    predicted.T_seen_now = trueMotion() * SE3(Eigen::Matrix3d::Identity(), {0, 0, change_m});
    return estimate(s.observations, s.labels(), predicted, 1).has_value();
  };
  constexpr double kSudden_m = 0.15, kSteady_m = 0.05;  // 15 and 5 m/s^2
  const PredictedMotion steady{.T_seen_now = {}, .dt_s = 0.1, .steady_frames = 10},
      unknown{.T_seen_now = {}, .dt_s = 0.1}, stood{.T_seen_now = {}, .dt_s = 0.1, .stood = true};
  for (const PredictedMotion& known : {steady, stood}) {
    EXPECT_FALSE(believed(20, kSudden_m, known));
    EXPECT_TRUE(believed(20, kSteady_m, known));
    EXPECT_TRUE(believed(80, kSudden_m, known));
  }
  EXPECT_TRUE(believed(20, kSudden_m, unknown));
}

TEST(EgoMotion, ASteadyMotionDoesNotBreakOff) {
  const EgoMotionEstimator estimate({}, kRig);
  const SE3 ahead(Eigen::Matrix3d::Identity(), {0, 0, 1}), braked(Eigen::Matrix3d::Identity(), {0, 0, 0.9});
  EXPECT_TRUE(estimate.breaks(SE3{}, {ahead, 0.1, 10}));
  EXPECT_FALSE(estimate.breaks(SE3{}, {ahead, 0.1, 1}));
  EXPECT_FALSE(estimate.breaks(SE3{}, {ahead, 0.5, 10}));
  EXPECT_FALSE(estimate.breaks(braked.inverse(), {ahead, 0.1, 10}));
}

TEST(EgoMotion, TellsDrivingFromSliding) {
  const auto moved = [](double x, double y, double z) { return SE3(Eigen::Matrix3d::Identity(), {x, y, z}); };
  EXPECT_TRUE(drivesAhead(moved(0.05, 0.04, 1), 0.1));
  EXPECT_FALSE(drivesAhead(moved(0, 0, 0.1), 0.1));
  EXPECT_FALSE(drivesAhead(moved(0, 0, -1), 0.1));
  EXPECT_FALSE(slides(moved(0, 0.04, 0), 0.1));
  EXPECT_FALSE(slides(moved(0.2, 0, 1), 0.1));
  EXPECT_TRUE(slides(moved(0.5, 0, 1), 0.1));
  EXPECT_FALSE(slides(moved(4, 0, 10), 1));  // a curve's chord
  const SE3 turn(expSO3({0, 0.05, 0}), {0, 0, 0.5});
  EXPECT_FALSE(slides(turn, 0.1));
  EXPECT_TRUE(slides(SE3(turn.rotation(), {0, 0, 0.01}), 0.1));
}

}  // namespace
}  // namespace motorcade
