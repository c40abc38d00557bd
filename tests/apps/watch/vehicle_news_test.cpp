#include "apps/watch/vehicle_news.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

/// Ten frames a second; the own vehicle is found in frame 5 and grows until frame 15.
std::vector<std::string> said(OwnVehicleNews& news, int frames) {
  std::vector<std::string> said;
  for (int i = 0; i < frames; ++i) {
    FrameMeasurements frame;
    frame.head.stamp = {i * 100'000'000};
    const double top_px = i < 15 ? 300 : 280;
    if (i >= 5) frame.own_vehicle = OwnVehicleView{(375 - top_px) / 375, {0, top_px, 1241, 374}};
    if (auto sentence = news.observe(frame)) said.push_back(*sentence);
  }
  return said;
}

TEST(OwnVehicleNews, AreToldOnceWhenTheOwnVehicleIsKnown) {
  OwnVehicleNews news;
  EXPECT_EQ(said(news, 60), std::vector<std::string>{"the own vehicle fills 25 % of the left image (columns 0 to 1241, "
                                                     "rows 280 to 374): nothing is followed there"});
  EXPECT_FALSE(news.finish());
  ASSERT_TRUE(news.view());
  EXPECT_EQ(news.view()->box.top_px, 280);
}

TEST(OwnVehicleNews, AreToldAtTheEndOfAShortDriveAndNotWhereThereIsNone) {
  OwnVehicleNews shortly, none;
  EXPECT_TRUE(said(shortly, 10).empty());
  EXPECT_TRUE(shortly.finish());
  EXPECT_TRUE(said(none, 3).empty());
  EXPECT_FALSE(none.finish());
}

using testing::HasSubstr;

FrameMeasurements measured(std::int64_t frame, const std::optional<VehicleSensors>& sensors) {
  FrameMeasurements measurements;
  measurements.head.frame = {frame};
  measurements.vehicle_sensors = sensors;
  return measurements;
}

VehicleSensors leftOut(const VehicleSensors::Motion& told, const VehicleSensors::Motion& seen) {
  return {.believed = false, .told = told, .seen = seen};
}

std::string newsOf(const VehicleSensors& sensors) {
  VehicleMotionNews news;
  return news.observe(measured(7, sensors)).value_or("");
}

TEST(VehicleMotionNews, NothingIsSaidOfSensorsThatAgreeAndWhereThereAreNone) {
  VehicleMotionNews news;
  EXPECT_FALSE(news.observe(measured(0, std::nullopt)));
  EXPECT_FALSE(news.observe(measured(1, VehicleSensors{})));
  EXPECT_FALSE(news.observe(measured(2, std::nullopt)));
  EXPECT_EQ(news.leftOut(), 0);
}

TEST(VehicleMotionNews, WhatChangesIsToldOnceWithBothMotions) {
  VehicleMotionNews news;
  const VehicleSensors sensors = leftOut({20, 0.01}, {12.5, 0.02});
  const auto first = news.observe(measured(30, sensors));
  ASSERT_TRUE(first);
  EXPECT_THAT(*first, testing::AllOf(HasSubstr("frame 30"), HasSubstr("20 m/s"), HasSubstr("12.5 m/s")));
  EXPECT_FALSE(news.observe(measured(31, sensors)));
  EXPECT_EQ(news.leftOut(), 2);
  EXPECT_THAT(news.observe(measured(40, VehicleSensors{})).value_or(""), HasSubstr("again"));
}

TEST(VehicleMotionNews, UnitsAndSignsAreGuessed) {
  EXPECT_THAT(newsOf(leftOut({36, 0}, {10, 0})), HasSubstr("km/h"));
  EXPECT_THAT(newsOf(leftOut({22.4, 0}, {10, 0})), HasSubstr("mph"));
  EXPECT_THAT(newsOf(leftOut({33, 0}, {10, 0})), HasSubstr("feet"));
  EXPECT_THAT(newsOf(leftOut({-10, 0}, {10, 0})), HasSubstr("positive ahead"));
  EXPECT_THAT(newsOf(leftOut({10, 5.7}, {10, 0.1})), HasSubstr("deg/s"));
  EXPECT_THAT(newsOf(leftOut({10, -0.1}, {10, 0.1})), HasSubstr("positive to the left"));
  EXPECT_THAT(newsOf(leftOut({0, 0}, {10, 0.1})), testing::Not(HasSubstr("looks like")));
}

TEST(VehicleMotionNews, ASensorThatComesAndGoesIsToldAFewTimesOnly) {
  VehicleMotionNews news;
  int told = 0;
  for (int frame = 0; frame < 100; ++frame)
    told += news.observe(measured(frame, frame % 2 == 0 ? leftOut({1, 0}, {2, 0}) : VehicleSensors{})).has_value();
  EXPECT_EQ(told, 10);
}

}  // namespace
}  // namespace motorcade
