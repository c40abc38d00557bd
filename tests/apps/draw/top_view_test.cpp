#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "apps/draw/top_map.hpp"
#include "apps/draw/views.hpp"
#include "tests/apps/draw/drawn_scene.hpp"

namespace motorcade {
namespace {

using test::carAhead;
using test::colorfulness;
using test::driveWith;
using test::labelAt;
using testing::Contains;
using testing::IsSupersetOf;
using testing::Not;

constexpr int kWide_px = 900, kHigh_px = 300;

/// A view, and the places of the scene's points in it.
struct Seen {
  RgbImage image;
  Marks marks;
  TopMap map;

  /// Color of the pixel at meters ahead and to the right.
  int colorAt(double ahead_m, double right_m) const {
    const Eigen::Vector2d at = map({right_m, 0, ahead_m});
    return colorfulness(image, static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
  }
};

Seen seen(const RecordedDrive& drive, std::size_t frame = 0) {
  Canvas canvas(kWide_px, kHigh_px, {});
  Marks marks;
  Sheet sheet{canvas, marks};
  paintTopView(sheet, drive, frame);
  constexpr double kLabels_px = 22;
  return {canvas.image(), marks, topMapOf(drive, frame, {0, 0, kWide_px - 1.0, kHigh_px - 1.0 - kLabels_px})};
}

TEST(TopView, ShowsTheFootprintAtItsPlace) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  const Seen view = seen(driveWith(car));
  for (const auto& [ahead_m, right_m] : {std::pair(10.3, 0.7), std::pair(10.3, -0.7), std::pair(13.7, 0.7)})
    EXPECT_GT(view.colorAt(ahead_m, right_m), 100) << ahead_m << ", " << right_m;
  for (const auto& [ahead_m, right_m] : {std::pair(9.6, 0.7), std::pair(14.4, 0.7), std::pair(12.0, 1.4)})
    EXPECT_LT(view.colorAt(ahead_m, right_m), 40) << ahead_m << ", " << right_m;
}

TEST(TopView, AFootprintReachesNoFartherThanItsPointsWhereItsLengthIsOnlyBelieved) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  car.cuboid->size_sigma_m = {0.9, 0.05, 0.05};
  RecordedDrive drive = driveWith(car);
  EXPECT_GT(seen(drive).colorAt(11.8, 0.7), 100) << "without points, what it surely has: 4 - 2 * .9 m from its rear";
  EXPECT_LT(seen(drive).colorAt(12.6, 0.7), 40);
  for (int i = 0; i < 10; ++i) drive.points[0].push_back(test::pointAt(drive, i, {0.5, 1.2, i % 2 == 0 ? 10.0 : 11.0}));
  EXPECT_GT(seen(drive).colorAt(10.3, 0.7), 100);
  EXPECT_LT(seen(drive).colorAt(11.4, 0.7), 40);
}

TEST(TopView, ShowsHowSureItIsOfThePlace) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  EXPECT_THAT(seen(driveWith(car)).marks, Not(Contains(Mark::kEllipse)));
  car.covariance = Matrix6d::Identity() * 1e-6;
  (*car.covariance)(0, 0) = 9;  // 3 m along its length
  const Seen view = seen(driveWith(car));
  EXPECT_THAT(view.marks, Contains(Mark::kEllipse));
  const auto isBright = [&](double ahead_m) {
    const Eigen::Vector2d at = view.map({0, 0, ahead_m});
    const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
    return std::max(*view.image.at(x - 1, y), std::max(*view.image.at(x, y), *view.image.at(x + 1, y))) > 100;
  };
  EXPECT_TRUE(isBright(18)) << "the ellipse ends 6 m from the middle";
  EXPECT_FALSE(isBright(18.4));
}

TEST(TopView, ShowsPointsAtTheirDepthAndMotionAheadOfTheNose) {
  ObjectEstimate car = carAhead();
  car.velocity_world_mps = {0, 0, 6};
  RecordedDrive drive = driveWith(car);
  const Seen moving = seen(drive);
  EXPECT_GT(moving.colorAt(17, 0), 100) << "3 m ahead of the nose";
  EXPECT_THAT(moving.marks, Contains(Mark::kMotion));
  EXPECT_THAT(moving.marks, Not(Contains(Mark::kPoint)));
  drive.points[0] = {test::pointAt(drive, 0, {3, 1, 9})};
  const Seen pointed = seen(drive);
  const Eigen::Vector2d at = pointed.map({3, 1, 9});
  EXPECT_GT(pointed.image.at(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())))[0], 150);
  EXPECT_THAT(pointed.marks, Contains(Mark::kPoint));
}

TEST(TopView, APredictedFootprintIsNotFilled) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kPredicted;
  const Seen view = seen(driveWith(car));
  EXPECT_LT(view.colorAt(10.5, 0.6), 80);
  EXPECT_THAT(view.marks, Contains(Mark::kPredicted));
  EXPECT_THAT(view.marks, Not(Contains(Mark::kFootprint)));
}

/// A drive of two frames in which label 5 drives 4 m and label 6 wanders by less than a meter.
RecordedDrive labeledDrive() {
  RecordedDrive drive = driveWith(carAhead());
  drive.stamps.push_back(Timestamp{100'000'000});
  drive.T_world_cam.resize(2);
  drive.T_world_cam_true.resize(2);
  drive.true_objects[0] = {labelAt(5, 3, 15), labelAt(6, -3, 8)};
  drive.true_objects[1] = {labelAt(5, 3, 19), labelAt(6, -3, 8.6)};
  drive.true_movers = {5};
  return drive;
}

TEST(TopView, TellsTheTruthOfMoversFromThatOfParkedCars) {
  const RecordedDrive drive = labeledDrive();
  EXPECT_THAT(seen(drive, 1).marks, IsSupersetOf({Mark::kTrueMover, Mark::kTrueParked, Mark::kTruePath}));
  RecordedDrive parked = drive;
  parked.true_movers.clear();
  EXPECT_THAT(seen(parked).marks, Not(Contains(Mark::kTrueMover)));
  EXPECT_NE(seen(parked).image.pixels, seen(drive).image.pixels);
}

TEST(TopView, UsesItsAreaAndHoldsWhatIsThere) {
  const RecordedDrive near = driveWith(carAhead());
  ObjectEstimate away = carAhead();
  away.T_world_body = SE3(away.T_world_body.rotation(), {-8, 0.75, 60});
  away.velocity_world_mps = {0, 0, 15};
  const RecordedDrive far = driveWith(away);
  const Rectangle area{0, 0, kWide_px, kHigh_px};
  const TopMap near_map = topMapOf(near, 0, area), far_map = topMapOf(far, 0, area);
  EXPECT_GT(near_map.px_per_m, 20);
  EXPECT_LT(far_map.px_per_m, 0.6 * near_map.px_per_m);
  EXPECT_TRUE(area.contains(far_map({-8, 0, 60})));
  EXPECT_TRUE(area.contains(far_map({-8, 0, 75}))) << "where it will be in a second";
  EXPECT_TRUE(area.contains(near_map({0, 0, -5}))) << "the own path";
}

TEST(TopView, TheScaleChangesLittleFromFrameToFrame) {
  RecordedDrive drive = driveWith(carAhead());
  drive.T_world_cam.resize(60);
  drive.stamps.resize(60);
  ObjectEstimate away = carAhead();
  away.T_world_body = SE3(away.T_world_body.rotation(), {-8, 0.75, 60});
  drive.objects[30] = {away};
  double before = topMapOf(drive, 0, {0, 0, kWide_px, kHigh_px}).px_per_m;
  for (std::size_t frame = 1; frame < 60; ++frame) {
    const double now = topMapOf(drive, frame, {0, 0, kWide_px, kHigh_px}).px_per_m;
    EXPECT_NEAR(now / before, 1, 0.15) << frame;
    before = now;
  }
}

TEST(TopView, WhatIsNoNumberIsLeftOut) {
  const double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  EXPECT_THAT(seen(RecordedDrive{}).marks, testing::IsEmpty());
  for (const double value : {none, endless}) {
    ObjectEstimate car = carAhead();
    car.T_world_body = SE3(Eigen::Matrix3d::Identity() * value, Eigen::Vector3d::Constant(value));
    car.velocity_world_mps.setConstant(value);
    car.covariance = Matrix6d::Constant(value);
    car.cuboid->size_m.setConstant(value);
    RecordedDrive drive = driveWith(car);
    drive.points[0] = {{.frame = {0}, .track = {1}, .point = {}, .uvd_px = {value, value, value}}};
    drive.T_world_cam_true = {SE3()};
    drive.true_objects[0] = {labelAt(1, value, value)};
    EXPECT_THAT(seen(drive).marks, testing::ElementsAre(Mark::kOwnCamera)) << value;
    drive.T_world_cam[0] = car.T_world_body;
    seen(drive);
    seen(drive, 5);  // a frame that is not there
  }
}

TEST(Legend, HasASampleOfItsOwnForEachMark) {
  std::set<std::string> pictures;
  const auto pictureOf = [](const Marks& marks) {
    Canvas canvas(kWide_px, legendHeight(kWide_px), {});
    drawLegend(canvas, marks);
    const RgbImage image = canvas.image();
    return std::string(image.pixels.begin(), image.pixels.end());
  };
  pictures.insert(pictureOf({}));
  for (int mark = 0; mark <= static_cast<int>(Mark::kTruePath); ++mark)
    pictures.insert(pictureOf({static_cast<Mark>(mark)}));
  EXPECT_EQ(pictures.size(), 2U + static_cast<std::size_t>(Mark::kTruePath));
}

TEST(Legend, HasRoomForAllMarksInPicturesOfAnyWidth) {
  Marks all;
  for (int mark = 0; mark <= static_cast<int>(Mark::kTruePath); ++mark) all.insert(static_cast<Mark>(mark));
  for (const int width : {320, 752, 1242}) {
    const int height = legendHeight(width);
    Canvas exact(width, height, {}), tall(width, height + 100, {});
    drawLegend(exact, all);
    drawLegend(tall, all);
    auto below = tall.image().pixels;
    below.erase(below.begin(), below.begin() + std::ptrdiff_t{3} * width * height);
    EXPECT_THAT(below, testing::Each(0)) << width;
  }
}

TEST(FrameView, NamesWhatItShowsAndNothingElse) {
  Canvas canvas(kWide_px, kHigh_px, {});
  Marks marks;
  Sheet sheet{canvas, marks};
  ObjectEstimate car = carAhead();
  car.velocity_world_mps = {0, 0, 6};
  RecordedDrive drive = labeledDrive();
  drive.objects[0] = {car};
  drive.true_objects[0].pop_back();  // the parked one
  paintTopView(sheet, drive, 0);
  EXPECT_EQ(marks, (Marks{Mark::kMotion, Mark::kFootprint, Mark::kOwnCamera, Mark::kTrueMover}));
}

TEST(FrameView, GivesTheSamePictureTwice) {
  RecordedDrive drive = labeledDrive();
  drive.objects[0].front().covariance = Matrix6d::Identity() * 0.01;
  const DrawnImages images{test::grayImage()};
  const RgbImage one = drawFrame(images, drive, 0), other = drawFrame(images, drive, 0);
  EXPECT_EQ(one.pixels, other.pixels);
  const RgbImage next = drawFrame(images, drive, 1);
  EXPECT_EQ(next.pixels.size(), one.pixels.size()) << "all frames have one size";
}

}  // namespace
}  // namespace motorcade
