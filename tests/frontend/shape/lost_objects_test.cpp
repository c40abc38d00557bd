#include "frontend/shape/lost_objects.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr TrackId kBus{2}, kCar{5};
const Eigen::Vector3d kVelocity_mps(0, 0, -8);

FrameEstimate frameWith(int frame, std::vector<ObjectEstimate> objects) {
  FrameEstimate estimate;
  estimate.head.frame = FrameId{frame};
  estimate.head.stamp.ns = 100'000'000LL * frame;
  estimate.objects = std::move(objects);
  return estimate;
}

ObjectEstimate seen(TrackId track, double z_m, double existence_probability = 1) {
  ObjectEstimate object;
  object.track = track;
  object.T_world_body = SE3(expSO3({0, 0.1, 0}), {-3, 0, z_m});
  object.velocity_world_mps = kVelocity_mps;
  object.cuboid.emplace();
  object.existence_probability = existence_probability;
  return object;
}

TEST(LostObjects, AreWhereTheyWouldBe) {
  LostObjects lost;
  lost.remember(frameWith(1, {seen(kBus, 30), seen(kCar, 12)}));
  EXPECT_TRUE(lost.predictedIn(frameWith(2, {seen(kBus, 29.2), seen(kCar, 12)})).empty());
  const auto predicted = lost.predictedIn(frameWith(4, {seen(kCar, 12)}));
  ASSERT_EQ(predicted.size(), 1U);
  EXPECT_EQ(predicted[0].track, kBus);
  EXPECT_LT((predicted[0].T_world_body.translation() - Eigen::Vector3d(-3, 0, 30 - 0.3 * 8)).norm(), 1e-9);
  EXPECT_EQ(predicted[0].T_world_body.rotation(), seen(kBus, 0).T_world_body.rotation());
}

TEST(LostObjects, AreForgottenAfterAWhile) {
  LostObjects lost;
  lost.remember(frameWith(0, {seen(kBus, 30)}));
  for (int frame = 1; frame <= LostObjects::kMost; ++frame) lost.remember(frameWith(frame, {}));
  EXPECT_EQ(lost.predictedIn(frameWith(LostObjects::kMost, {})).size(), 1U);
  lost.remember(frameWith(LostObjects::kMost + 1, {}));
  EXPECT_TRUE(lost.predictedIn(frameWith(LostObjects::kMost + 1, {})).empty());
}

TEST(LostObjects, WereSurelyThere) {
  LostObjects lost;
  lost.remember(frameWith(0, {seen(kBus, 30, 0.8)}));
  EXPECT_TRUE(lost.predictedIn(frameWith(1, {})).empty());
}

/// Nobody knows how the camera moved in between.
TEST(LostObjects, AreForgottenWhereTheCamerasPathBreaks) {
  LostObjects lost;
  lost.remember(frameWith(0, {seen(kBus, 30)}));
  FrameEstimate elsewhere = frameWith(1, {});
  elsewhere.head.segment = 1;
  EXPECT_TRUE(lost.predictedIn(elsewhere).empty());
  lost.remember(elsewhere);
  EXPECT_TRUE(lost.predictedIn(elsewhere).empty());
}

}  // namespace
}  // namespace motorcade
