#include "frontend/shape/earlier_views.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

constexpr TrackId kWalker{4};
constexpr double kWay_m = 0.1, kDistance_m = 10;  // of a person in a frame: 7.2 px

Features framed(int frame) {
  auto pair = std::make_shared<StereoFrame>();
  pair->head.frame = FrameId{frame};
  Features features;
  features.frame = pair;
  ImagePool pool;
  features.left.levels = {pool.acquire(64, 32), pool.acquire(32, 16)};
  return features;
}

SE3 placeIn(int frame) { return {Eigen::Matrix3d::Identity(), {kWay_m * frame, 0, kDistance_m}}; }

/// A person who walks before a camera at rest, as it is seen in so many frames.
EarlierViews walkOf(int frames) {
  EarlierViews earlier(kRig);
  for (int frame = 0; frame < frames; ++frame) {
    earlier.move(SE3{});
    earlier.addPlace(kWalker, FrameId{frame}, placeIn(frame));
    earlier.add(framed(frame));
  }
  earlier.move(SE3{});
  return earlier;
}

ObjectView viewIn(int frame) {
  ObjectView view;
  view.T_cam_body = placeIn(frame);
  return view;
}

TEST(EarlierViews, GiveTheNewestInWhichBodyAndRestAreWellApart) {
  const EarlierViews earlier = walkOf(5);
  const auto last = earlier.last(kWalker, viewIn(5), framed(5));
  const auto well = earlier.wellApart(kWalker, viewIn(5), framed(5));
  ASSERT_TRUE(last && well);
  EXPECT_EQ(last->frame, FrameId{4});
  EXPECT_NEAR(last->apart, 3.6, 1e-9) << "cells of two pixels";
  EXPECT_EQ(well->frame, FrameId{3}) << "7.2 cells";
  EXPECT_EQ(well->T_before_body.translation(), placeIn(3).translation());
}

TEST(EarlierViews, GoBackUntilASmallBodyHasGoneByItsWidth) {
  const EarlierViews earlier = walkOf(5);
  ObjectView view = viewIn(5);
  const auto frame = [&](double width) {
    view.width = width;
    return earlier.wellApart(kWalker, view, framed(5))->frame;
  };
  EXPECT_EQ(frame(2), FrameId{3}) << "narrower than what is well apart";
  EXPECT_EQ(frame(13), FrameId{1}) << "14.4 cells";
  EXPECT_EQ(frame(30), FrameId{0}) << "the farthest where none is far enough";
}

TEST(EarlierViews, GiveTheFarthestWhereNoneIsWellApart) {
  const EarlierViews earlier = walkOf(1);
  const auto well = earlier.wellApart(kWalker, viewIn(1), framed(1));
  ASSERT_TRUE(well);
  EXPECT_EQ(well->frame, FrameId{0});
  EXPECT_FALSE(earlier.wellApart(TrackId{5}, viewIn(1), framed(1))) << "nobody knows where it was";
}

TEST(EarlierViews, CarryTheCamerasMotionAlong) {
  EarlierViews earlier(kRig);
  earlier.addPlace(kWalker, FrameId{0}, placeIn(0));
  earlier.add(framed(0));
  const SE3 T_previous_now(expSO3({0, 0.1, 0}), {0, 0, 1});
  earlier.move(T_previous_now);  // a frame that is not seen
  earlier.move(T_previous_now);
  const SE3 T_before_cam = earlier.last(kWalker, viewIn(2), framed(2))->T_before_cam;
  EXPECT_LT((T_before_cam.inverse() * T_previous_now * T_previous_now).log().norm(), 1e-12);
}

TEST(EarlierViews, ForgetWhatIsOld) {
  const EarlierViews earlier = walkOf(20);
  EXPECT_EQ(earlier.place(kWalker, FrameId{13}), nullptr);
  ASSERT_NE(earlier.place(kWalker, FrameId{14}), nullptr);
  EXPECT_EQ(earlier.place(kWalker, FrameId{14})->translation(), placeIn(14).translation());
}

}  // namespace
}  // namespace motorcade
