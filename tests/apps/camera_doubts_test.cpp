#include "apps/check/camera_doubts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using testing::HasSubstr;

const StereoCamera kCamera{720, 720, 620, 188, 0.54, 1242, 375};

TEST(DoubtsAboutACamera, NoneOfAnOrdinaryOne) { EXPECT_TRUE(doubtsAbout(kCamera).empty()); }

TEST(DoubtsAboutACamera, NameWhatCannotBe) {
  StereoCamera millimeters = kCamera, of_larger = kCamera, absurd = kCamera;
  millimeters.baseline_m *= 1000;
  of_larger.cx_px *= 2.1;
  absurd.fx_px = 1e308;
  ASSERT_EQ(doubtsAbout(millimeters).size(), 1U);
  EXPECT_THAT(doubtsAbout(millimeters)[0], HasSubstr("baseline of 540 m"));
  ASSERT_EQ(doubtsAbout(of_larger).size(), 1U);
  EXPECT_THAT(doubtsAbout(of_larger)[0], HasSubstr("(1302, 188) lies outside"));
  StereoCamera of_half = kCamera;
  of_half.fx_px /= 2, of_half.fy_px /= 2, of_half.cx_px /= 2, of_half.cy_px /= 2;
  ASSERT_EQ(doubtsAbout(of_half).size(), 1U);
  EXPECT_THAT(doubtsAbout(of_half)[0], HasSubstr("far from the middle"));
  ASSERT_EQ(doubtsAbout(absurd).size(), 1U);
  EXPECT_THAT(doubtsAbout(absurd)[0], HasSubstr("focal length of 1e+308 px"));
}

}  // namespace
}  // namespace motorcade
