#include "apps/watch/own_vehicle_news.hpp"

#include <string>
#include <vector>

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

}  // namespace
}  // namespace motorcade
