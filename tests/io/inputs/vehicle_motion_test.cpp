#include "io/inputs/vehicle_motion.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/io/three_pairs.hpp"

namespace motorcade {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class VehicleMotionFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }
  std::string problemOf(const std::string& name, const std::string& text) {
    const auto file = write(name, text);
    return test::messageOf<InputError>([&] { readVehicleMotion(file, sequence_); });
  }

  test::TemporaryFolder folder_;
  Sequence sequence_ = [] {
    Sequence sequence;
    for (int i = 0; i < 3; ++i) sequence.stamps.push_back({10'000'000'000 + 100'000'000 * i});
    sequence.stamps_measured = true;
    return sequence;
  }();
};

const std::string kHeader = "time_s,speed_mps,yaw_rate_radps\n";

TEST_F(VehicleMotionFile, ATableIsReadInOrderOfTime) {
  const auto samples = readVehicleMotion(write("motion.csv", kHeader + "10.1,2,0.5\n10.0,1.5,-1e-2\n"), sequence_);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].stamp.ns, 10'000'000'000);
  EXPECT_EQ(samples[0].speed_mps, 1.5);
  EXPECT_EQ(samples[0].yaw_rate_radps, -1e-2);
  EXPECT_EQ(samples[0].speed_sigma_mps, 0);
  EXPECT_EQ(samples[1].stamp.ns, 10'100'000'000);
}

TEST_F(VehicleMotionFile, DeviationsAreReadWhereTheyAreGiven) {
  const auto samples = readVehicleMotion(
      write("motion.csv", "time_s,speed_mps,yaw_rate_radps,speed_sigma_mps,yaw_rate_sigma_radps\n10,1,0,.2,.01\n"),
      sequence_);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].speed_sigma_mps, .2);
  EXPECT_EQ(samples[0].yaw_rate_sigma_radps, .01);
}

TEST_F(VehicleMotionFile, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_THAT(problemOf("a.csv", ""), HasSubstr("is empty"));
  EXPECT_THAT(problemOf("a.csv", kHeader), HasSubstr("no sample"));
  EXPECT_THAT(problemOf("a.csv", "t,v,w\n1,2,3\n"), AllOf(HasSubstr("begins with 't,v,w'"), HasSubstr("time_s,")));
  EXPECT_THAT(problemOf("a.csv", kHeader + "10,1,0\n10.1,fast,0\n"), AllOf(HasSubstr("a.csv"), HasSubstr("3")));
  EXPECT_THAT(problemOf("a.csv", kHeader + "10,1\n"), HasSubstr("yaw_rate_radps"));
  EXPECT_THAT(problemOf("a.csv", kHeader + "10,1,0,4\n"), HasSubstr("a.csv"));
  EXPECT_THAT(problemOf("a.csv", "time_s,speed_mps,yaw_rate_radps,speed_sigma_mps,yaw_rate_sigma_radps\n10,1,0,-1,0\n"),
              HasSubstr("speed_sigma_mps is negative"));
}

TEST_F(VehicleMotionFile, TimesOfAnotherClockAreRefused) {
  EXPECT_THAT(problemOf("a.csv", kHeader + "0,1,0\n0.1,1,0\n"),
              AllOf(HasSubstr("not those of the images"), HasSubstr("one clock")));
}

/// Latitude to yaw, then vn ve vf vl vu, ax to au, wx to wl, wu, and what follows.
std::string packet(double vf_mps, double wu_radps) {
  return "49 8 112 0 0 0 1 2 " + std::to_string(vf_mps) + " .1 .2 1 2 3 4 5 6 7 8 9 10 11 " + std::to_string(wu_radps) +
         " .1 .01 4 10 4 4 0\n";
}

TEST_F(VehicleMotionFile, PacketsOfKittiTellSpeedAndYawRate) {
  const auto samples =
      readVehicleMotion(write("oxts.txt", packet(12, .1) + packet(12.5, .2) + packet(13, .3)), sequence_);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[1].speed_mps, 12.5);
  EXPECT_EQ(samples[1].yaw_rate_radps, .2);
  EXPECT_EQ(samples[1].stamp, sequence_.stamps[1]);
}

TEST_F(VehicleMotionFile, TimesOfPacketsAreMovedToTheClockOfTheImages) {
  sequence_.truth.oxts_timestamps = write("oxts_timestamps.txt", "2011-09-26 13:10:51.02\n2011-09-26 13:10:51.12\n");
  sequence_.truth.image_timestamps = write("image_timestamps.txt", "2011-09-26 13:10:51.0\n2011-09-26 13:10:51.1\n");
  const auto samples = readVehicleMotion(write("oxts.txt", packet(12, .1) + packet(12.5, .2)), sequence_);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].stamp.ns, 10'020'000'000);
}

TEST_F(VehicleMotionFile, ShortenedPacketsAreNotEnough) {
  EXPECT_THAT(problemOf("oxts.txt", "49 8 112 0 0 0\n49 8 112 0 0 0\n49 8 112 0 0 0\n"),
              HasSubstr("fields 9 (vf) and 23 (wu)"));
}

TEST(VehicleMotionSource, APairKnowsTheSamplesUpToItsTime) {
  VehicleMotionSource source(std::make_unique<test::ThreePairs>(),
                             {{.stamp = {0}}, {.stamp = {99}}, {.stamp = {100}}, {.stamp = {101}}, {.stamp = {500}}});
  for (const std::uint64_t known : {1, 3, 4}) {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    ASSERT_TRUE(frame->inputs.vehicle_motion);
    EXPECT_EQ(frame->inputs.vehicle_samples, known);
    EXPECT_EQ(frame->inputs.vehicle_motion->count(), known);
  }
  EXPECT_FALSE(source.next());
  EXPECT_EQ(source.finish().remark, "the end");
}

}  // namespace
}  // namespace motorcade
