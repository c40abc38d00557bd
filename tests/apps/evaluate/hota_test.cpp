#include "apps/evaluate/measures/hota.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr double kHotaTol = 1e-12;  // rounding of sums of nineteen

/// A frame with one label, 7, and the tracks with their similarities to it.
HotaFrame frameOfTracks(const std::vector<std::pair<std::int64_t, double>>& tracks) {
  HotaFrame frame{.labels = {7}, .tracks = {}, .similarity = Eigen::MatrixXd(1, std::ssize(tracks))};
  for (const auto& [id, similarity] : tracks) {
    frame.similarity(0, std::ssize(frame.tracks)) = similarity;
    frame.tracks.push_back(id);
  }
  return frame;
}

TEST(HotaOf, APerfectResultIsOneInEveryPart) {
  HotaFrame frame{.labels = {7, 8}, .tracks = {2, 1}, .similarity = Eigen::MatrixXd(2, 2)};
  frame.similarity << 0, 1, 1, 0;
  const Hota hota = hotaOf({frame, frame, frame});
  EXPECT_EQ(hota.labels, 6);
  EXPECT_EQ(hota.rows, 6);
  for (const double part :
       {hota.hota, hota.det_a, hota.det_re, hota.det_pr, hota.ass_a, hota.ass_re, hota.ass_pr, hota.loc_a})
    EXPECT_NEAR(part, 1, kHotaTol);
}

/// Track 1 is there in the first half of four frames, track 2 in the second. Each match shares two frames with its
/// track, out of the label's four.
TEST(HotaOf, AnIdentitySwitchInTheMiddleHalvesTheAssociation) {
  const Hota hota =
      hotaOf({frameOfTracks({{1, 1}}), frameOfTracks({{1, 1}}), frameOfTracks({{2, 1}}), frameOfTracks({{2, 1}})});
  EXPECT_NEAR(hota.det_a, 1, kHotaTol);
  EXPECT_NEAR(hota.ass_a, 2.0 / (4 + 2 - 2), kHotaTol);
  EXPECT_NEAR(hota.ass_re, 0.5, kHotaTol);
  EXPECT_NEAR(hota.ass_pr, 1, kHotaTol);
  EXPECT_NEAR(hota.hota, std::sqrt(0.5), kHotaTol);
}

/// Track 1 is there in three of the label's four frames, track 2 once elsewhere: three matches, one missed, one false.
TEST(HotaOf, AMissAndAFalseRowCostDetection) {
  const Hota hota =
      hotaOf({frameOfTracks({{2, 0}, {1, 1}}), frameOfTracks({{1, 1}}), frameOfTracks({{1, 1}}), frameOfTracks({})});
  EXPECT_NEAR(hota.det_a, 3.0 / (3 + 1 + 1), kHotaTol);
  EXPECT_NEAR(hota.det_re, 3.0 / 4, kHotaTol);
  EXPECT_NEAR(hota.det_pr, 3.0 / 4, kHotaTol);
  EXPECT_NEAR(hota.ass_a, 3.0 / (4 + 3 - 3), kHotaTol);
  EXPECT_NEAR(hota.hota, std::sqrt(0.6 * 0.75), kHotaTol);
}

/// Similarities 0.52 and 0.82 of one track. Both frames match at the ten thresholds up to 0.5 (all parts 1, LocA 0.67);
/// one does at the six from 0.55 to 0.8 (DetA 1 / (1 + 1 + 1), AssA 1 / (2 + 2 - 1), LocA 0.82); none at the other
/// three.
TEST(HotaOf, BoxesThatDoNotFitMatchAtTheLowThresholdsOnly) {
  const Hota hota = hotaOf({frameOfTracks({{1, 0.52}}), frameOfTracks({{1, 0.82}})});
  EXPECT_NEAR(hota.det_a, (10 + 6 / 3.0) / 19, kHotaTol);
  EXPECT_NEAR(hota.det_re, (10 + 6 / 2.0) / 19, kHotaTol);
  EXPECT_NEAR(hota.ass_a, (10 + 6 / 3.0) / 19, kHotaTol);
  EXPECT_NEAR(hota.ass_pr, (10 + 6 / 2.0) / 19, kHotaTol);
  EXPECT_NEAR(hota.hota, (10 + 6 / 3.0) / 19, kHotaTol);
  EXPECT_NEAR(hota.loc_a, (10 * 0.67 + 6 * 0.82 + 3) / 19, kHotaTol);
}

/// Track 2 lies better on the label in the middle frame than track 1, which follows it throughout. Matched by
/// similarity alone, track 2 would take that frame; the alignment with the whole drive gives it to track 1: (1 + 0.72 /
/// 1.52 + 1) / (3 + 3 - that) against (0.8 / 1.52) / (3 + 1 - that). So up to 0.7, at 14 thresholds, there are three
/// matches, all of track 1, and a false row.
TEST(HotaOf, MatchesPreferTheTrackThatFollowsTheLabel) {
  const Hota hota =
      hotaOf({frameOfTracks({{1, 0.72}}), frameOfTracks({{2, 0.8}, {1, 0.72}}), frameOfTracks({{1, 0.72}})});
  EXPECT_NEAR(hota.det_a, 14 / 19.0 * 3 / 4, kHotaTol);
  EXPECT_NEAR(hota.ass_a, 14 / 19.0, kHotaTol);
  EXPECT_NEAR(hota.loc_a, (14 * 0.72 + 5) / 19, kHotaTol);
  EXPECT_NEAR(hota.hota, 14 / 19.0 * std::sqrt(0.75), kHotaTol);
}

TEST(HotaOf, WithoutLabelsOrWithoutRowsIsZero) {
  EXPECT_EQ(hotaOf({}).hota, 0);
  EXPECT_EQ(hotaOf({frameOfTracks({})}).hota, 0);
  const HotaFrame only_false{.labels = {}, .tracks = {1}, .similarity = Eigen::MatrixXd(0, 1)};
  EXPECT_EQ(hotaOf({only_false}).hota, 0);
  EXPECT_EQ(hotaOf({only_false}).rows, 1);
}

}  // namespace
}  // namespace motorcade
