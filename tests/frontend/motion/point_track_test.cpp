#include "frontend/motion/point_track.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

PointObservation observation(int step) {
  return {step, Eigen::Vector3f(static_cast<float>(step), 1, 2), Eigen::Vector3f::Constant(0.5F)};
}

TEST(PointTrack, KeepsTheNewestObservations) {
  PointTrack track;
  for (int step = 0; step < PointTrack::kCapacity + 3; ++step) track.add(observation(step));
  EXPECT_EQ(track.count, PointTrack::kCapacity);
  EXPECT_EQ(track.oldest().step, 3);
  EXPECT_EQ(track.newest().step, PointTrack::kCapacity + 2);
  EXPECT_FALSE(track.find(2));
  ASSERT_TRUE(track.find(5));
  EXPECT_EQ(track.find(5)->uvd_px.x(), 5);
}

TEST(PointTrack, FindsNothingInFramesThatItMissed) {
  PointTrack track;
  track.add(observation(1));
  track.add(observation(3));
  EXPECT_FALSE(track.find(2));
  const StereoCorrespondence c = track.sinceThen(track.oldest());
  EXPECT_EQ(c.uvd_then_px, Eigen::Vector3d(1, 1, 2));
  EXPECT_EQ(c.uvd_now_px, Eigen::Vector3d(3, 1, 2));
}

TEST(PointTrack, AnExtendedTrackIsTheOneBeforeWithAnotherObservation) {
  PointTrack before, track;
  before.point = {3};
  before.label = PointLabel::kGround;
  before.ambiguity = 2;
  track.flow.emplace();
  track.p_static_cam = Eigen::Vector3d(1, 2, 3);
  for (int step = 0; step < PointTrack::kCapacity + 3; ++step) {
    track.extend(before, observation(step));
    before.add(observation(step));
    ASSERT_EQ(track.count, before.count);
    for (int i = 0; i < track.count; ++i) EXPECT_EQ(track.observations[i].step, before.observations[i].step);
  }
  EXPECT_EQ(track.point, PointId{3});
  EXPECT_EQ(track.label, PointLabel::kGround);
  EXPECT_EQ(track.ambiguity, 2);
  EXPECT_FALSE(track.flow);
  EXPECT_FALSE(track.p_static_cam);
}

TEST(PointTrack, ANewPointInTheMemoryOfAnOldOneKnowsNothingOfIt) {
  PointTrack track;
  track.point = {3};
  track.add(observation(1));
  track.flow.emplace();
  track.p_static_cam = Eigen::Vector3d(1, 2, 3);
  track.label = PointLabel::kMoving;
  track.ambiguity = 2;
  track.restart({7});
  EXPECT_EQ(track.point, PointId{7});
  EXPECT_EQ(track.count, 0);
  EXPECT_FALSE(track.flow);
  EXPECT_FALSE(track.p_static_cam);
  EXPECT_EQ(track.label, PointLabel::kUnknown);
  EXPECT_EQ(track.ambiguity, 0);
}

}  // namespace
}  // namespace motorcade
