#include "apps/evaluate/comparison/object_positions.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/apps/evaluate/followed_label_by_hand.hpp"

namespace motorcade {
namespace {

using test::followedByHand;

const Eigen::Vector3d kOffset_m{0.5, -0.8, 0.2};
constexpr double kPositionRounding = 1e-9;

Eigen::Vector3d fixedOrigin(int /*frame*/) { return kOffset_m; }

double rmseOf(const PositionErrors& errors, PositionKind kind) { return errors.of(kind).rmse; }

TEST(PositionErrors, AConstantOffsetIsRemovedWhereTheLabelTurnsToo) {
  const auto errors = positionErrors(followedByHand(0, 30, fixedOrigin));
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->frames, 30U);
  EXPECT_NEAR(rmseOf(*errors, PositionKind::kWorld), kOffset_m.norm(), kPositionRounding);
  EXPECT_NEAR(rmseOf(*errors, PositionKind::kAsSeen), kOffset_m.norm(), kPositionRounding);
  for (const PositionKind kind :
       {PositionKind::kWorldOffsetRemoved, PositionKind::kAlignedOffsetRemoved, PositionKind::kAsSeenOffsetRemoved})
    EXPECT_NEAR(rmseOf(*errors, kind), 0, kPositionRounding);
  EXPECT_NEAR(errors->are_deg.max, 0, 1e-5);  // an angle near zero loses half of the digits
  EXPECT_NEAR(errors->are_as_seen_deg.max, 0, 1e-5);
  EXPECT_NEAR(errors->origin_drift_m->norm(), 0, kPositionRounding);
}

TEST(PositionErrors, ASlideAlongTheObjectStaysAsErrorAndAsDriftOfTheOrigin) {
  const auto sliding = [](int i) -> Eigen::Vector3d { return kOffset_m + Eigen::Vector3d(0.05 * i, 0, -0.01 * i); };
  const auto errors = positionErrors(followedByHand(0, 21, sliding));
  // The median is the middle of the slide: |i - 10| steps are left, whose squares add up to 770.
  const double step_m = std::hypot(0.05, 0.01);
  const Statistics& seen = errors->of(PositionKind::kAsSeenOffsetRemoved);
  EXPECT_NEAR(seen.rmse, step_m * std::sqrt(770.0 / 21), kPositionRounding);
  EXPECT_NEAR(seen.mean, step_m * 110 / 21, kPositionRounding);
  EXPECT_NEAR(seen.median, step_m * 5, kPositionRounding);
  EXPECT_EQ(seen.count, 21U);
  // Medians over five frames stand for the frames 2 to 18.
  EXPECT_NEAR((*errors->origin_drift_m - Eigen::Vector3d(0.8, 0, 0.16)).norm(), 0, kPositionRounding);
}

TEST(PositionErrors, SeenFromTheCameraItsDriftDoesNotMatter) {
  const auto drift = [](int i) { return SE3(expSO3({0, 0.002 * i, 0}), {0.1 * i, 0, 0}); };
  const auto errors = positionErrors(followedByHand(0, 30, fixedOrigin, drift));
  EXPECT_GT(rmseOf(*errors, PositionKind::kWorldOffsetRemoved), 1);
  EXPECT_NEAR(rmseOf(*errors, PositionKind::kAsSeenOffsetRemoved), 0, kPositionRounding);
}

TEST(PositionErrors, AlignmentTakesOutAPathThatIsMovedAsAWhole) {
  const SE3 moved(expSO3({0, 0.2, 0.1}), {3, 1, -2});
  const auto errors = positionErrors(followedByHand(0, 30, fixedOrigin, [&](int) { return SE3(moved); }));
  EXPECT_GT(rmseOf(*errors, PositionKind::kWorldOffsetRemoved), 1);
  EXPECT_LT(rmseOf(*errors, PositionKind::kAligned), kOffset_m.norm());
  EXPECT_FALSE(positionErrors(followedByHand(0, 1, fixedOrigin))) << "one frame has no path";
}

TEST(OriginDrift, SkipsSingleFramesAndFramesFarAway) {
  const auto jumping = [](int i) -> Eigen::Vector3d {
    if (i == 12) return {9, 9, 9};
    return i < 55 ? kOffset_m : Eigen::Vector3d(5, 5, 5);  // 30 m away in frame 50
  };
  const auto errors = positionErrors(followedByHand(0, 60, jumping));
  EXPECT_NEAR(errors->origin_drift_m->norm(), 0, kPositionRounding);
  EXPECT_FALSE(positionErrors(followedByHand(70, 90, fixedOrigin))->origin_drift_m);
}

TEST(MeanPositionErrors, CountObjectsThatWereFollowedLongEnough) {
  const auto near = positionErrors(followedByHand(0, 30, fixedOrigin)),
             far = positionErrors(followedByHand(0, 30, [](int) { return Eigen::Vector3d(3, 0, 0); })),
             brief = positionErrors(followedByHand(0, 9, [](int) { return Eigen::Vector3d(50, 0, 0); }));
  const MeanPositionErrors mean = meanOf({*near, *brief, *far});
  EXPECT_EQ(mean.objects, 2);
  EXPECT_NEAR(mean.ate_m[static_cast<std::size_t>(PositionKind::kAsSeen)], (kOffset_m.norm() + 3) / 2,
              kPositionRounding);
}

/// An origin that swings along its object's x axis, with a constant offset beside it.
auto swinging(double size_m) {
  return
      [size_m](int i) -> Eigen::Vector3d { return kOffset_m + Eigen::Vector3d(i % 2 == 0 ? size_m : -size_m, 0, 0); };
}

TEST(CompareRuns, TakesTheFramesThatBothHave) {
  const auto ours = [](int i) { return i < 10 ? Eigen::Vector3d(7, 0, 0) : swinging(0.1)(i); };
  const RunComparison comparison = compareRuns({followedByHand(0, 30, ours)}, {followedByHand(10, 50, swinging(0.25))});
  ASSERT_EQ(comparison.objects.size(), 1U);
  EXPECT_EQ(comparison.objects[0].ours.frames, 20U);
  EXPECT_EQ(comparison.objects[0].baseline.frames, 20U);
  const auto seen = static_cast<std::size_t>(PositionKind::kAsSeenOffsetRemoved);
  EXPECT_NEAR(comparison.objects[0].relativeError(seen), 0.6, kPositionRounding);
  EXPECT_NEAR(comparison.mean_relative_error[seen], 0.6, kPositionRounding);
}

TEST(CompareRuns, TakesTheTracksWithTheMostFramesInCommonAndLeavesLonelyLabelsOut) {
  FollowedLabel brief = followedByHand(0, 12, swinging(5)), other = followedByHand(0, 30, swinging(5));
  brief.track = {1};
  other.label = 8;
  FollowedLabel rest = followedByHand(12, 40, swinging(0.1));
  const RunComparison comparison = compareRuns({brief, rest, other}, {followedByHand(0, 40, swinging(0.2))});
  ASSERT_EQ(comparison.objects.size(), 1U);
  EXPECT_EQ(comparison.objects[0].track, TrackId{3});
  EXPECT_EQ(comparison.objects[0].ours.frames, 28U);
  EXPECT_NEAR(comparison.objects[0].relativeError(static_cast<std::size_t>(PositionKind::kWorldOffsetRemoved)), 0.5,
              kPositionRounding);
}

}  // namespace
}  // namespace motorcade
