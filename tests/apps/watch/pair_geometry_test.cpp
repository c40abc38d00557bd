#include "apps/watch/pair_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

const StereoCamera kStreetCamera{720, 720, 620, 188, 0.54, 1242, 375};

struct Rig {
  double down_px = 0, roll_rad = 0, k1 = 0;
  double up_m = 0, ahead_m = 0;  // of the right camera
};

/// Points of a street, as a rig sees them in whose right image every tenth point is matched wrongly.
std::vector<EpipolarMatch> seenBy(const Rig& rig, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(0, 1242), v(0, 375), inverse_depth(0.01, 0.2), wrong_px(-15, 15);
  std::normal_distribution<double> noise_px(0, 0.2);
  const auto pixel = [&](double x, double y) {
    const double growth = 1 + rig.k1 * (x * x + y * y);
    return Eigen::Vector2d(kStreetCamera.cx_px + kStreetCamera.fx_px * x * growth,
                           kStreetCamera.cy_px + kStreetCamera.fy_px * y * growth);
  };
  std::vector<EpipolarMatch> matches;
  for (int i = 0; i < 3000; ++i) {
    const double x = (u(random) - kStreetCamera.cx_px) / kStreetCamera.fx_px,
                 y = (v(random) - kStreetCamera.cy_px) / kStreetCamera.fy_px;
    const double depth_m = 1 / inverse_depth(random), depth_right_m = depth_m - rig.ahead_m;
    const Eigen::Vector2d left = pixel(x, y), right = pixel((x * depth_m - kStreetCamera.baseline_m) / depth_right_m,
                                                            (y * depth_m + rig.up_m) / depth_right_m);
    const double turned_px = rig.down_px + rig.roll_rad * (right.x() - kStreetCamera.cx_px);
    const double outlier_px = i % 10 == 0 ? wrong_px(random) : 0;
    matches.push_back({left.x(), left.y(), right.x(), right.y() + turned_px + noise_px(random) + outlier_px});
  }
  return matches;
}

TEST(PairGeometry, OfARectifiedRigIsZero) {
  const PairGeometry geometry = estimatePairGeometry(seenBy({}, 1), kStreetCamera);
  for (const RowErrorEstimate& error : geometry.errors) EXPECT_LT(std::abs(error.value), 4 * error.sigma);
  EXPECT_LT(geometry.remaining_px, 0.3);
  EXPECT_NEAR(geometry.agreeing_share, 0.9, 0.03);
}

TEST(PairGeometry, IsWhatTheRigIs) {
  const PairGeometry geometry = estimatePairGeometry(seenBy({3, 0.017, -0.05, 0, 0}, 2), kStreetCamera);
  EXPECT_NEAR(geometry[RowError::kOffset].value, 3, 0.2);
  EXPECT_NEAR(geometry[RowError::kRoll].value, 0.017, 0.002);
  EXPECT_NEAR(geometry[RowError::kBarrel].value, -0.05, 0.015);
  for (const RowError error : {RowError::kZoom, RowError::kLift, RowError::kAhead})
    EXPECT_LT(geometry[error].effect_px, 0.5);
}

TEST(PairGeometry, TellsWhereTheRightCameraStands) {
  Rig rig;
  rig.up_m = 0.05, rig.ahead_m = 0.08;
  const PairGeometry geometry = estimatePairGeometry(seenBy(rig, 4), kStreetCamera);
  EXPECT_NEAR(geometry[RowError::kLift].value, rig.up_m / kStreetCamera.baseline_m, 0.02);
  EXPECT_NEAR(geometry[RowError::kAhead].value, rig.ahead_m / kStreetCamera.baseline_m, 0.04);
}

TEST(PairGeometry, ErrorsThatNothingShowsStayUnsure) {
  std::vector<EpipolarMatch> far;  // distortion shows in disparities alone
  for (EpipolarMatch match : seenBy({}, 3)) {
    match.u_right_px = match.u_left_px;
    far.push_back(match);
  }
  const RowErrorEstimate barrel = estimatePairGeometry(far, kStreetCamera)[RowError::kBarrel];
  EXPECT_LT(std::abs(barrel.value), 1e-6);
  EXPECT_GT(barrel.sigma, 0.3);
  EXPECT_GT(estimatePairGeometry({}, kStreetCamera)[RowError::kOffset].sigma, 10);
}

TEST(MatchUnrectified, FindsRowsAndDisparitiesOfEitherSign) {
  const test::Texture texture(71, 10, 80);
  for (const auto& [right_px, down_px] : {std::pair(-30.0, 6.5), std::pair(40.0, -11.0)}) {
    const double u_px = right_px, v_px = down_px;
    const auto shifted = [&](double x, double y) { return texture(x - u_px, y - v_px); };
    ImagePool pool;
    const Image left = test::render(640, 300, texture, {.noise = 2, .seed = 4}),
                right = test::render(640, 300, shifted, {.noise = 2, .seed = 5});
    const PreparedPair pair = preparePair(left, right, pool);
    const auto matches = matchUnrectified(pair.left, pair.right, pair.corners, 200);
    EXPECT_GT(matches.size(), 80U);
    const auto good = std::ranges::count_if(matches, [&](const EpipolarMatch& match) {
      return std::abs(match.rowDifference_px() - v_px) < 0.2 && std::abs(match.disparity_px() + u_px) < 0.2;
    });
    EXPECT_GT(static_cast<double>(good), 0.95 * static_cast<double>(matches.size()));
  }
}

TEST(MatchUnrectified, FindsNothingInImagesTooSmall) {
  ImagePool pool;
  const Image tiny = test::render(30, 24, test::Texture(1));
  const PreparedPair pair = preparePair(tiny, tiny, pool);
  EXPECT_TRUE(matchUnrectified(pair.left, pair.right, {{15, 12, 9}}, 200).empty());
}

}  // namespace
}  // namespace motorcade
