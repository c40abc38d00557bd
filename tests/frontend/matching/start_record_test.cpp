#include "frontend/matching/start_record.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr int kWidth = 640, kHeight = 200;
constexpr float kU_px = 639, kV_px = 199;  // the last pixel

/// A record of frames in each of which so many points started at one place.
StartRecord recordOf(int frames, int started, int followed) {
  StartRecord record;
  for (int frame = 0; frame < frames; ++frame) {
    record.beginFrame(kWidth, kHeight);
    for (int i = 0; i < started; ++i) record.add(kU_px, kV_px, i < followed);
  }
  return record;
}

TEST(StartRecord, TriesPlacesOfWhichNothingIsKnown) {
  EXPECT_TRUE(StartRecord().isWorthTrying(kU_px, kV_px));
  EXPECT_TRUE(recordOf(1, 0, 0).isWorthTrying(kU_px, kV_px));
}

TEST(StartRecord, LeavesOutPlacesWherePointsAreHardlyEverFollowed) {
  const StartRecord record = recordOf(5, 3, 0);
  EXPECT_FALSE(record.isWorthTrying(kU_px, kV_px));
  EXPECT_TRUE(record.isWorthTrying(kU_px - 48, kV_px));
  EXPECT_FALSE(recordOf(5, 10, 1).isWorthTrying(kU_px, kV_px));
}

TEST(StartRecord, GoesOnWherePointsAreFollowedUsually) { EXPECT_TRUE(recordOf(5, 3, 1).isWorthTrying(kU_px, kV_px)); }

TEST(StartRecord, TriesAPlaceAgainAfterSomeFrames) {
  StartRecord record = recordOf(5, 3, 0);
  int frames = 0;
  while (!record.isWorthTrying(kU_px, kV_px)) {
    record.beginFrame(kWidth, kHeight);
    ASSERT_LT(++frames, 10);
  }
  EXPECT_GT(frames, 1);
}

TEST(StartRecord, BeginsAnewWithImagesOfAnotherSize) {
  StartRecord record = recordOf(5, 3, 0);
  record.beginFrame(2 * kWidth, kHeight);
  EXPECT_TRUE(record.isWorthTrying(kU_px, kV_px));
}

}  // namespace
}  // namespace motorcade
