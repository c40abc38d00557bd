#include "apps/evaluate/kind_measures.hpp"

#include <gtest/gtest.h>

#include "tests/apps/compared_frame_by_hand.hpp"

namespace motorcade {
namespace {

using test::labelByHand;
using test::rowByHand;

TEST(KindOfType, KnowsTheTypesOfTheLabels) {
  EXPECT_EQ(kindOfType("Van"), ObjectKind::kCar);
  EXPECT_EQ(kindOfType("Tram"), ObjectKind::kLargeVehicle);
  EXPECT_EQ(kindOfType("Cyclist"), ObjectKind::kTwoWheeler);
  EXPECT_EQ(kindOfType("Pedestrian"), ObjectKind::kPedestrian);
  EXPECT_EQ(kindOfType("Misc"), ObjectKind::kUnknown);
}

/// Twelve frames with a truck that is taken for a car until frame 10, a car whose cuboid is not known in the last
/// frame, and something whose label has no kind.
std::vector<ComparedFrame> drive() {
  std::vector<ComparedFrame> frames(12);
  for (int i = 0; i < 12; ++i) {
    frames[i].objects = {labelByHand(7, 20), labelByHand(8, 25), labelByHand(9, 10), labelByHand(10, 35)};
    frames[i].objects[0].truth.type = "Truck";
    frames[i].objects[2].truth.type = "Misc";
    for (int j = 0; j < 4; ++j) frames[i].rows.push_back(rowByHand(j, j, 20));
    if (i >= 10) frames[i].rows[0].row.object.cuboid->kind = ObjectKind::kLargeVehicle;
  }
  frames.back().rows[1].row.object.cuboid.reset();
  return frames;
}

TEST(KindErrors, CountFromATracksTenthRowOnAndBefore) {
  const KindErrors errors = kindErrors(drive(), 30);
  EXPECT_EQ(errors.before.total(), 18);
  EXPECT_EQ(errors.before.of(ObjectKind::kLargeVehicle, ObjectKind::kCar), 9);
  EXPECT_EQ(errors.before.shareRight(), 0.5);
  EXPECT_EQ(errors.from_tenth_row.total(), 6);
  EXPECT_EQ(errors.from_tenth_row.of(ObjectKind::kLargeVehicle, ObjectKind::kCar), 1);
  EXPECT_EQ(errors.from_tenth_row.of(ObjectKind::kLargeVehicle, ObjectKind::kLargeVehicle), 2);
  EXPECT_EQ(errors.from_tenth_row.of(ObjectKind::kCar, ObjectKind::kCar), 2);
  EXPECT_EQ(errors.from_tenth_row.of(ObjectKind::kCar, ObjectKind::kUnknown), 1);
  EXPECT_NEAR(errors.from_tenth_row.shareRight(), 4.0 / 6, 1e-12);
}

TEST(KindErrors, CountRowsThatAreNotMeasuredAsRowsOfTheTrack) {
  auto frames = drive();
  for (int i = 0; i < 9; ++i) frames[i].rows[0].object = -1;
  const KindErrors errors = kindErrors(frames, 30);
  EXPECT_EQ(errors.before.total(), 9);
  EXPECT_EQ(errors.from_tenth_row.total(), 6);
}

}  // namespace
}  // namespace motorcade
