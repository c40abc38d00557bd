#include "apps/evaluate/measures/tracking_measures.hpp"

#include <gtest/gtest.h>

#include "tests/apps/evaluate/compared_frame_by_hand.hpp"

namespace motorcade {
namespace {

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
