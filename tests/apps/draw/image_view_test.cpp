#include <limits>

#include <gmock/gmock.h>

#include "apps/draw/tags.hpp"
#include "apps/draw/views.hpp"
#include "tests/apps/draw/drawn_scene.hpp"

namespace motorcade {
namespace {

using test::carAhead;
using test::colorfulness;
using test::drawImageView;
using test::driveWith;
using test::grayImage;
using test::kHeight_px;
using test::kWidth_px;
using testing::Contains;
using testing::Not;

Marks marksOf(const DrawnImages& images, const RecordedDrive& drive) {
  Canvas canvas(images.left);
  Marks marks;
  Sheet sheet{canvas, marks};
  paintImageView(sheet, images, drive, 0);
  return marks;
}

TEST(ImageView, ShowsTheCuboidsEdgesWhereTheyProject) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  const RgbImage image = drawImageView({grayImage()}, driveWith(car), 0);
  // The near face is 10 m away: 60 px wide and 45 px high around (200, 60 + 22.5), the far one 14 m.
  for (const auto& [x, y] : {std::pair(170, 82), std::pair(230, 82), std::pair(200, 105)})
    EXPECT_GT(colorfulness(image, x, y), 100) << x << ", " << y;
  EXPECT_GT(colorfulness(image, 179, 82), 20) << "hidden, but there";
  EXPECT_LT(colorfulness(image, 179, 82), colorfulness(image, 170, 82));
  EXPECT_EQ(colorfulness(image, 190, 97), 0) << "nothing lies between the edges";
}

TEST(ImageView, CutsACuboidThatReachesBehindTheCamera) {
  ObjectEstimate car = carAhead();
  car.T_world_body = SE3(car.T_world_body.rotation(), {2.5, 0.75, 1.5});  // beside the camera, from -.5 to 3.5 m
  const RgbImage image = drawImageView({grayImage()}, driveWith(car), 0);
  EXPECT_GT(colorfulness(image, 329, 82), 100) << "the far face's left edge, 1.5 m right and 3.5 m ahead";
}

TEST(ImageView, ACuboidIsDrawnNoLongerThanPointsWereSeen) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  car.cuboid->size_sigma_m = {0.9, 0.05, 0.05};
  RecordedDrive drive = driveWith(car);
  for (int i = 0; i < 10; ++i)  // on its rear, and half a meter farther
    drive.points[0].push_back(test::pointAt(drive, i, {0.5, 1.2, i % 2 == 0 ? 10.0 : 10.5}));
  const RgbImage image = drawImageView({grayImage()}, drive, 0);
  EXPECT_GT(colorfulness(image, 230, 75), 100) << "the near face";
  EXPECT_EQ(colorfulness(image, 179, 75), 0) << "the far face is not known";
  EXPECT_GT(colorfulness(image, 172, 75), 10) << "what is known ends at 10.5 m";
}

TEST(ImageView, TintsTheMaskAndMarksPoints) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  RecordedDrive drive = driveWith(car);
  DrawnImages images{.left = grayImage(), .mask = Gray16Image{.width = kWidth_px, .height = kHeight_px, .pixels = {}}};
  images.mask->pixels.assign(std::size_t{kWidth_px} * kHeight_px, 0);
  for (int y = 85; y < 101; ++y)
    for (int x = 183; x < 199; ++x) images.mask->pixels[y * kWidth_px + x] = 2;  // track 1
  drive.points[0] = {{.frame = {0}, .track = {1}, .point = {}, .uvd_px = {215, 95, 12}}};
  const RgbImage image = drawImageView(images, drive, 0);
  EXPECT_GT(colorfulness(image, 190, 93), 30);
  EXPECT_LT(colorfulness(image, 190, 93), 100) << "translucent";
  EXPECT_GT(colorfulness(image, 190, 85), 80) << "the rim";
  EXPECT_EQ(colorfulness(image, 204, 97), 0);
  EXPECT_GT(image.at(215, 95)[1], 200) << "the point";
  EXPECT_THAT(marksOf(images, drive), testing::IsSupersetOf({Mark::kMask, Mark::kPoint}));
}

TEST(ImageView, APredictedObjectIsDrawnDashed) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kPredicted;
  const RgbImage predicted = drawImageView({grayImage()}, driveWith(car), 0);
  int gaps = 0;
  for (int x = 172; x < 228; ++x) gaps += colorfulness(predicted, x, 105) < 60;
  EXPECT_GT(gaps, 10) << "of the lower near edge";
  EXPECT_LT(gaps, 40);
  EXPECT_THAT(marksOf({grayImage()}, driveWith(car)), Contains(Mark::kPredicted));
  EXPECT_THAT(marksOf({grayImage()}, driveWith(car)), Not(Contains(Mark::kCuboid)));
  EXPECT_THAT(marksOf({grayImage()}, driveWith(carAhead())), Not(Contains(Mark::kPredicted)));
}

TEST(ImageView, AnObjectWithoutACuboidHasItsBox) {
  ObjectEstimate car = carAhead();
  car.cuboid.reset();
  const RgbImage image = drawImageView({grayImage()}, driveWith(car), 0);
  EXPECT_GT(colorfulness(image, 170, 80), 100);
  EXPECT_THAT(marksOf({grayImage()}, driveWith(car)), Contains(Mark::kBox));
}

TEST(ImageView, TagsOfObjectsInOneDirectionDoNotOverlap) {
  const std::vector<Tag> tags(
      4, Tag{.color = {250, 180, 60}, .name = "#1 car", .facts = "12 m · 8.0 ±0.2 m/s", .anchor = {170, 55, 60, 50}});
  Canvas canvas(grayImage());
  Marks marks;
  Sheet sheet{canvas, marks};
  const auto plates = paintTags(sheet, tags);
  ASSERT_EQ(plates.size(), 4U);
  for (std::size_t i = 0; i < plates.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) EXPECT_EQ(plates[i].overlap(plates[k]), 0) << i << " and " << k;
  EXPECT_THAT(marks, testing::ElementsAre(Mark::kTag));
}

TEST(ImageView, WhatIsNoNumberIsLeftOut) {
  const double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  const RgbImage plain = drawImageView({grayImage()}, RecordedDrive{}, 0);
  for (const double value : {none, endless, -endless, 1e300}) {
    ObjectEstimate car = carAhead();
    car.T_world_body = SE3(Eigen::Matrix3d::Identity() * value, Eigen::Vector3d::Constant(value));
    car.velocity_world_mps.setConstant(value);
    car.speed_sigma_mps = value;
    car.box = {value, value, value, value};
    car.cuboid->size_m.setConstant(value);
    car.cuboid->size_sigma_m.setConstant(value);
    RecordedDrive drive = driveWith(car);
    drive.points[0] = {{.frame = {0}, .track = {1}, .point = {}, .uvd_px = {value, value, value}}};
    EXPECT_EQ(drawImageView({grayImage()}, drive, 0).pixels, plain.pixels) << value;
    drive.T_world_cam[0] = car.T_world_body;
    EXPECT_EQ(drawImageView({grayImage()}, drive, 0).pixels, plain.pixels) << value;
  }
}

}  // namespace
}  // namespace motorcade
