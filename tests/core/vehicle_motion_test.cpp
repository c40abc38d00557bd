#include "core/vehicle_motion.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(VehicleMotionLog, ReadersFindSamplesByTheirNumber) {
  VehicleMotionLog log(4);
  for (int i = 0; i < 3; ++i) log.add({.stamp = {i}});
  EXPECT_EQ(log.count(), 3U);
  const auto middle = log.read(1, 3);
  ASSERT_EQ(middle.size(), 2U);
  EXPECT_EQ(middle[0].stamp.ns, 1);
  EXPECT_EQ(middle[1].stamp.ns, 2);
  EXPECT_TRUE(log.read(3, 3).empty());
  EXPECT_TRUE(log.read(3, 9).empty());
}

TEST(VehicleMotionLog, TheOldestMakeRoomForTheNewest) {
  VehicleMotionLog log(4);
  for (int i = 0; i < 10; ++i) log.add({.stamp = {i}});
  const auto held = log.read(0, 10);
  ASSERT_EQ(held.size(), 4U);
  EXPECT_EQ(held.front().stamp.ns, 6);
  EXPECT_EQ(held.back().stamp.ns, 9);
}

}  // namespace
}  // namespace motorcade
