#include "apps/check/sequence_remarks.hpp"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using testing::HasSubstr;

const StereoCamera kOrdinaryCamera{720, 720, 620, 188, 0.54, 1242, 375};

TEST(DoubtsAboutACamera, NoneOfAnOrdinaryOne) { EXPECT_TRUE(doubtsAbout(kOrdinaryCamera).empty()); }

TEST(DoubtsAboutACamera, NameWhatCannotBe) {
  StereoCamera millimeters = kOrdinaryCamera, of_larger = kOrdinaryCamera, absurd = kOrdinaryCamera;
  millimeters.baseline_m *= 1000;
  of_larger.cx_px *= 2.1;
  absurd.fx_px = 1e308;
  ASSERT_EQ(doubtsAbout(millimeters).size(), 1U);
  EXPECT_THAT(doubtsAbout(millimeters)[0], HasSubstr("baseline of 540 m"));
  ASSERT_EQ(doubtsAbout(of_larger).size(), 1U);
  EXPECT_THAT(doubtsAbout(of_larger)[0], HasSubstr("(1302, 188) lies outside"));
  StereoCamera of_half = kOrdinaryCamera;
  of_half.fx_px /= 2, of_half.fy_px /= 2, of_half.cx_px /= 2, of_half.cy_px /= 2;
  ASSERT_EQ(doubtsAbout(of_half).size(), 1U);
  EXPECT_THAT(doubtsAbout(of_half)[0], HasSubstr("far from the middle"));
  ASSERT_EQ(doubtsAbout(absurd).size(), 1U);
  EXPECT_THAT(doubtsAbout(absurd)[0], HasSubstr("focal length of 1e+308 px"));
}

TEST(DoubtsAboutACamera, NoneOfWhatIsOnlyUnusual) {
  const StereoCamera d435i{382.6, 382.6, 321.1, 237.6, 0.04999, 640, 480},
      d405{435.2, 435.2, 423.5, 241.7, 0.018, 848, 480};
  for (const StereoCamera& camera : {d435i, d405}) {
    EXPECT_TRUE(doubtsAbout(camera).empty());
    EXPECT_TRUE(odditiesOf(camera).empty());
  }
  // 1280x720 cut to its rows from 200 on, and to those up to 450: cy at 160 of 520, and at 360 of 450.
  for (const auto& [cy_px, height_px] : {std::pair(160.0, 520), std::pair(360.0, 450), std::pair(75.0, 300)}) {
    const StereoCamera cut{700, 700, 640, cy_px, 0.12, 1280, height_px};
    EXPECT_TRUE(doubtsAbout(cut).empty()) << cy_px;
    EXPECT_TRUE(odditiesOf(cut).empty()) << cy_px;
  }
  const StereoCamera nearly_all_cut{700, 700, 640, 50, 0.12, 1280, 410};
  EXPECT_TRUE(doubtsAbout(nearly_all_cut).empty());
  ASSERT_EQ(odditiesOf(nearly_all_cut).size(), 1U);
  EXPECT_THAT(odditiesOf(nearly_all_cut)[0], HasSubstr("row 50 of images 410 px high"));
}

TEST(DoubtsAboutACamera, RemainWhereUnitsOrSizesAreWrong) {
  StereoCamera without_focal = kOrdinaryCamera, centimeters = kOrdinaryCamera, side_by_side = kOrdinaryCamera,
               of_three_quarters = kOrdinaryCamera;
  without_focal.baseline_m = 0.54 / 720;  // P1 with -0.54 in place of -720 * 0.54
  centimeters.baseline_m = 12;
  side_by_side.width_px *= 2;
  of_three_quarters.cx_px *= 0.66, of_three_quarters.cy_px *= 0.66;
  for (const StereoCamera& camera : {without_focal, centimeters, side_by_side, of_three_quarters})
    EXPECT_EQ(doubtsAbout(camera).size(), 1U);
  StereoCamera confused = kOrdinaryCamera;  // fx, cx, fy, cy in this order
  confused.fy_px = 620, confused.cx_px = 720;
  EXPECT_THAT(odditiesOf(confused)[0], HasSubstr("the order is fx, fy, cx, cy"));
}

}  // namespace
}  // namespace motorcade
