#include "backend/joint/body_points.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "backend/joint/undecided_points.hpp"

namespace motorcade {
namespace {

constexpr BodyPoints::Params kParams{
    .max_views = 5, .max_landmarks = 40, .half = 0, .image_width_px = 800, .image_height_px = 400};

PointMeasurement point(int id, float u_px = 100, float v_px = 100) {
  return {.point = {id}, .uvd_px = {u_px, v_px, 10}, .sigma_px = {0.2F, 0.2F, 0.2F}};
}

/// Frames in which each point is counted, over all tracks that ended and those that go on.
std::multiset<std::pair<std::int64_t, std::int64_t>> counted(BodyPoints& points) {
  std::multiset<std::pair<std::int64_t, std::int64_t>> all;
  const auto add = [&](const LandmarkTrack& track) {
    for (const auto& view : track.views) all.insert({track.point.value, view.frame.value});
  };
  for (const LandmarkTrack& track : points.takeEnded()) add(track);
  for (const LandmarkTrack* track : points.current()) add(*track);
  return all;
}

TEST(BodyPoints, CountsEachViewOfALongTrackOnce) {
  BodyPoints points(kParams);
  for (int frame = 0; frame < 14; ++frame) points.observe({frame}, std::vector{point(7)});
  const auto all = counted(points);
  EXPECT_EQ(all.size(), 14U);
  for (int frame = 0; frame < 14; ++frame) EXPECT_EQ(all.count({7, frame}), 1U) << frame;
}

TEST(BodyPoints, CutsATrackThatOutlivesTheWindow) {
  BodyPoints points(kParams);
  for (int frame = 0; frame < 12; ++frame) points.observe({frame}, std::vector{point(7)});
  const auto ended = points.takeEnded();
  ASSERT_EQ(ended.size(), 2U);
  EXPECT_EQ(ended[0].views.size(), 5U);
  EXPECT_EQ(ended[1].views.front().frame, FrameId{5});
}

TEST(BodyPoints, EndsTracksFromAFrameThatLeaves) {
  BodyPoints points(kParams);
  for (int frame = 0; frame < 3; ++frame) points.observe({frame}, std::vector{point(7)});
  for (int frame = 3; frame < 5; ++frame) points.observe({frame}, std::vector{point(7), point(8, 300)});
  points.endFrom({0});
  const auto ended = points.takeEnded();
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].point, PointId{7});
  EXPECT_EQ(ended[0].views.size(), 4U) << "that of frame 3 goes on";
  points.observe({5}, std::vector{point(7), point(8, 300)});
  std::set<std::pair<std::int64_t, std::size_t>> views;
  for (const LandmarkTrack* track : points.current()) views.insert({track->point.value, track->views.size()});
  EXPECT_EQ(views, (std::set<std::pair<std::int64_t, std::size_t>>{{7, 2}, {8, 3}}));
}

/// A cut leaves views in few frames, the same for all points, however long they are followed.
TEST(BodyPoints, ACutLeavesATrackSparseEarlierViews) {
  constexpr int kFrames = 200, kOldest = 64, kMostViews = 14;
  BodyPoints::Params params = kParams;
  params.max_views = kMostViews;
  params.oldest_kept_frames = kOldest;
  BodyPoints points(params);
  std::set<std::int64_t> frames;
  for (int frame = 0; frame < kFrames; ++frame) {
    std::vector seen{point(7)};
    if (frame >= 3) seen.push_back(point(8, 300));
    points.observe({frame}, seen);
    frames.clear();
    for (const LandmarkTrack* track : points.current()) {
      EXPECT_LE(static_cast<int>(track->views.size()), kMostViews);
      for (const auto& view : track->views) frames.insert(view.frame.value);
    }
    EXPECT_LE(frames.size(), 20U) << frame;
  }
  EXPECT_LT(*frames.begin(), kFrames - kOldest / 2);
  EXPECT_GE(*frames.begin(), kFrames - kOldest - kMostViews);
  const auto all = counted(points);
  for (int frame = kFrames - kMostViews; frame < kFrames; ++frame) EXPECT_EQ(all.count({7, frame}), 1U) << frame;
  EXPECT_EQ(std::set(all.begin(), all.end()).size(), all.size());  // none is counted twice
  EXPECT_GE(all.size(), std::size_t{2 * kFrames - 3 - 4});         // and hardly one is lost
}

TEST(BodyPoints, EndsATrackWhosePointIsLost) {
  BodyPoints points(kParams);
  for (int frame = 0; frame < 3; ++frame) points.observe({frame}, std::vector{point(7)});
  for (int frame = 3; frame < 8; ++frame) points.observe({frame}, {});
  EXPECT_TRUE(points.current().empty());
  EXPECT_EQ(points.takeEnded().size(), 1U);
}

TEST(BodyPoints, BringsAlongWhatWasSeenOfNewPointsBefore) {
  BodyPoints points(kParams);
  UndecidedPoints undecided;
  for (int frame = 2; frame < 5; ++frame) undecided.observe({frame}, std::vector{point(7), point(8)});
  points.observe({5}, std::vector{point(7)}, [&](PointId p) { return undecided.take(p, {5}, 3); });
  ASSERT_EQ(points.current().size(), 1U);
  EXPECT_EQ(points.current().front()->views.size(), 4U);
  EXPECT_TRUE(undecided.take({7}, {6}, 3).empty());
  EXPECT_EQ(undecided.take({8}, {4}, 3).size(), 2U);  // of frames 2 and 3
}

TEST(UndecidedPoints, ForgetsPointsThatWereLostOrLongUndecided) {
  UndecidedPoints undecided;
  undecided.observe({0}, std::vector{point(7)});
  for (int frame = 1; frame < 6; ++frame) undecided.observe({frame}, std::vector{point(8)});
  EXPECT_TRUE(undecided.take({7}, {6}, 3).empty());
  EXPECT_TRUE(undecided.take({8}, {6}, 3).empty());
}

TEST(BodyPoints, SpreadsLandmarksOverTheImage) {
  BodyPoints points(kParams);
  std::vector<PointMeasurement> seen;
  for (int i = 0; i < 200; ++i) seen.push_back(point(i, 50, 50));               // a crowd in one corner
  for (int i = 0; i < 8; ++i) seen.push_back(point(200 + i, 100.0F * i, 300));  // and a row of single points
  for (int frame = 0; frame < 3; ++frame) points.observe({frame}, seen);
  const auto current = points.current();
  EXPECT_EQ(current.size(), 40U);
  EXPECT_EQ(std::ranges::count_if(current, [](const auto* track) { return track->point.value >= 200; }), 8);
}

TEST(BodyPoints, ForgetsPointsOfAnotherBody) {
  BodyPoints points(kParams);
  for (int frame = 0; frame < 3; ++frame) points.observe({frame}, std::vector{point(7), point(8)});
  points.forget(std::vector{point(7)});
  ASSERT_EQ(points.current().size(), 1U);
  EXPECT_EQ(points.current().front()->point, PointId{8});
  EXPECT_TRUE(points.takeEnded().empty());
}

TEST(BodyPoints, HalvesShareNoPoint) {
  std::set<std::int64_t> seen_by[3];
  for (const int half : {1, 2}) {
    auto params = kParams;
    params.half = half;
    BodyPoints points(params);
    for (int frame = 0; frame < 3; ++frame)
      points.observe({frame}, std::vector{point(1), point(2), point(3), point(4)});
    for (const LandmarkTrack* track : points.current()) seen_by[half].insert(track->point.value);
  }
  EXPECT_EQ(seen_by[1], (std::set<std::int64_t>{1, 3}));
  EXPECT_EQ(seen_by[2], (std::set<std::int64_t>{2, 4}));
}

}  // namespace
}  // namespace motorcade
