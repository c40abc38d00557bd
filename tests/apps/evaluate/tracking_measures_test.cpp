#include "apps/evaluate/measures/tracking_measures.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/apps/evaluate/compared_frame_by_hand.hpp"

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

using test::labelByHand;
using test::rowByHand;

/// The label 7 at 20 m, and a row of track 3 on it.
ComparedFrame frameOfOne() {
  ComparedFrame frame;
  frame.objects = {labelByHand(7, 20)};
  frame.rows = {rowByHand(3, 0, 20)};
  return frame;
}

TEST(MovingObjectsHota, IsOneForBoxesAndFootprintsThatFit) {
  EXPECT_NEAR(movingObjectsHota({frameOfOne(), frameOfOne()}, HotaBox::kImage, 30).hota, 1, 1e-9);
  EXPECT_NEAR(movingObjectsHota({frameOfOne(), frameOfOne()}, HotaBox::kFootprint, 30).hota, 1, 1e-9);
}

TEST(MovingObjectsHota, TakesTheFootprintFromTheCuboidSeenFromTheEstimatedCamera) {
  ComparedFrame frame = frameOfOne();
  frame.rows = {rowByHand(3, 0, 20, 0.5)};  // half a meter aside of two: IoU 0.6
  const Hota aside = movingObjectsHota({frame}, HotaBox::kFootprint, 30);
  EXPECT_NEAR(aside.det_re, 12 / 19.0, 1e-9) << "0.05 to 0.6";
  frame.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0.5, 0, 0});
  EXPECT_NEAR(movingObjectsHota({frame}, HotaBox::kFootprint, 30).hota, 1, 1e-9);
  frame.rows[0].row.object.cuboid.reset();
  const Hota without = movingObjectsHota({frame}, HotaBox::kFootprint, 30);
  EXPECT_EQ(without.rows, 1);
  EXPECT_EQ(without.hota, 0);
}

TEST(MovingObjectsHota, LeavesOutRowsOnLabelsThatAreNotAskedFor) {
  ComparedFrame frame = frameOfOne();
  TrueObject hidden = labelByHand(8, 15), resting = labelByHand(9, 18), far = labelByHand(10, 40);
  hidden.counted = false;
  resting.moving = false;
  for (const TrueObject& object : {hidden, resting, far}) {
    frame.rows.push_back(rowByHand(10 + static_cast<int>(object.truth.id), static_cast<int>(frame.objects.size()), 15));
    frame.objects.push_back(object);
  }
  MatchedRow open = rowByHand(30, -1, 25);
  open.in_ignored_area = true;
  frame.rows.push_back(open);
  const Hota near = movingObjectsHota({frame}, HotaBox::kImage, 30);
  EXPECT_EQ(near.labels, 1);
  EXPECT_EQ(near.rows, 1);
  EXPECT_NEAR(near.hota, 1, 1e-9);
  const Hota with_far = movingObjectsHota({frame}, HotaBox::kImage, 50);
  EXPECT_EQ(with_far.labels, 2);
  EXPECT_EQ(with_far.rows, 2);
}

TEST(MovingObjectsHota, HoldsRowsOnNothingAndOnParkedCarsAgainstTheRun) {
  ComparedFrame frame = frameOfOne();
  TrueObject parked = labelByHand(8, 15, 5);
  parked.moving = parked.ever_moves = false;
  frame.objects.push_back(parked);
  frame.rows.push_back(rowByHand(4, 1, 15, 5));
  frame.rows.push_back(rowByHand(5, -1, 25, -5));
  for (int i : {1, 2}) frame.rows[i].row.object.box = {400, 100, 500, 150};
  const Hota hota = movingObjectsHota({frame}, HotaBox::kImage, 30);
  EXPECT_EQ(hota.labels, 1);
  EXPECT_NEAR(hota.det_re, 1, 1e-9);
  EXPECT_NEAR(hota.det_pr, 1.0 / 3, 1e-9);
}

TEST(FirstReports, CountTheFramesThatALabelIsAskedForBefore) {
  std::vector<ComparedFrame> frames(6);
  for (int i = 0; i < 6; ++i) {
    frames[i].objects = {labelByHand(7, 20), labelByHand(8, 40), labelByHand(9, 25), labelByHand(10, 60)};
    frames[i].objects[0].counted = i != 1;                      // is not asked for in frame 1
    if (i >= 3) frames[i].rows.push_back(rowByHand(3, 0, 20));  // after frames 0 and 2
    if (i >= 4) frames[i].rows.push_back(rowByHand(4, 1, 40));  // after four frames, beyond 30 m
    frames[i].rows.push_back(rowByHand(5, 2, 25));              // never: as it is not observed
    frames[i].rows.back().row.object.state = ObjectState::kPredicted;
  }
  const FirstReports near = firstReports(frames, 30), far = firstReports(frames, 50);
  EXPECT_EQ(near.labels, 2);
  EXPECT_EQ(near.never, 1);
  EXPECT_EQ(near.frames.count, 1U);
  EXPECT_EQ(near.frames.mean, 2);
  EXPECT_EQ(far.labels, 3);
  EXPECT_EQ(far.frames.mean, 3);
  EXPECT_EQ(far.frames.max, 4);
}

TEST(FirstReports, AreAtOnceForWhatWasReportedBeforeItIsAskedFor) {
  std::vector<ComparedFrame> frames(3);
  for (int i = 0; i < 3; ++i) {
    frames[i].objects = {labelByHand(7, 32.0 - 2 * i)};  // nearer than 30 m in the last frame
    if (i == 0) frames[i].rows.push_back(rowByHand(3, 0, 32));
  }
  const FirstReports reports = firstReports(frames, 30);
  EXPECT_EQ(reports.labels, 1);
  EXPECT_EQ(reports.never, 0);
  EXPECT_EQ(reports.frames.max, 0);
}

}  // namespace
}  // namespace motorcade
