#include "frontend/shape/kind_belief.hpp"

#include <utility>

#include <gtest/gtest.h>

#include "tests/frontend/shape/street_by_hand.hpp"

namespace motorcade {
namespace {

using test::StreetByHand;

/// A measurement of each face of a cuboid of a size, as good as if it were independent of all others.
FaceInformation seenFaces(const Eigen::Vector3d& size_m, double sigma_m) {
  const BoxFaces faces = StreetByHand::faces(size_m);
  FaceInformation information;
  for (int face = 0; face < 6; ++face) information.add(Vector6d::Unit(face), faces[face], sigma_m);
  return information;
}

constexpr double kFine_m = 0.05;

TEST(KindBelief, IsSureOfUsualSizesAndSpeeds) {
  const auto expectKind = [](ObjectKind kind, const Eigen::Vector3d& size_m, double speed_mps) {
    const ObjectBox box = believedBox(seenFaces(size_m, kFine_m), {speed_mps});
    EXPECT_EQ(box.kind, kind) << size_m.transpose();
    EXPECT_GT(box.kind_probability, 0.95) << size_m.transpose();
  };
  expectKind(ObjectKind::kCar, {4.3, 1.8, 1.5}, 15);
  expectKind(ObjectKind::kCar, {5.4, 2.0, 2.2}, 15);  // a van
  expectKind(ObjectKind::kLargeVehicle, {11, 2.5, 3.3}, 15);
  expectKind(ObjectKind::kTwoWheeler, {1.8, 0.6, 1.7}, 5);
  expectKind(ObjectKind::kPedestrian, {0.8, 0.6, 1.75}, 1.3);
}

TEST(KindBelief, AReachSpeaksAgainstWhatIsShorterAlone) {
  const auto probability_of_car = [](double reach_m) {
    FaceInformation seen;
    if (reach_m > 0) seen.addReach(kFront, 0.5 * reach_m, kFine_m), seen.addReach(kRear, -0.5 * reach_m, kFine_m);
    const ObjectBox box = believedBox(seen, {3});
    return std::pair(box.kind, box.kind_probability);
  };
  EXPECT_EQ(probability_of_car(0.3), probability_of_car(0)) << "all kinds are longer";
  EXPECT_EQ(probability_of_car(4).first, ObjectKind::kCar);
  EXPECT_GT(probability_of_car(4).second, probability_of_car(0).second);
}

TEST(KindBelief, SpeedTellsWalkersFromRiders) {
  const FaceInformation person = seenFaces({1.2, 0.6, 1.75}, 0.3);
  EXPECT_EQ(believedBox(person, {1.3}).kind, ObjectKind::kPedestrian);
  EXPECT_EQ(believedBox(person, {5}).kind, ObjectKind::kTwoWheeler);
}

TEST(KindBelief, SaysWhatMayBeSmall) {
  const FaceInformation unseen, car = seenFaces({4.3, 1.8, 1.5}, kFine_m);
  EXPECT_EQ(smallKind(unseen, {1.4}, 0.6), ObjectKind::kPedestrian);
  EXPECT_EQ(smallKind(unseen, {4.5}, 0.2), ObjectKind::kTwoWheeler);
  EXPECT_EQ(smallKind(unseen, {4.5}, 0.6), ObjectKind::kUnknown) << "cars are as likely that slow";
  EXPECT_EQ(smallKind(unseen, {15}, 0.2), ObjectKind::kUnknown);
  EXPECT_EQ(smallKind(car, {4.5}, 0.2), ObjectKind::kUnknown);
}

/// A part of a flank looks like a motorcycle; points a car's length apart say more than that.
TEST(KindBelief, PointsFarApartAreOnNoMotorcycle) {
  const FaceInformation part = seenFaces({1.8, 0.6, 1.65}, 0.5);
  EXPECT_EQ(believedBox(part, {8}).kind, ObjectKind::kTwoWheeler);
  const ObjectBox car = believedBox(part, {8, {3, 1.2, 0.9}});
  EXPECT_EQ(car.kind, ObjectKind::kCar);
  EXPECT_GT(car.size_m.x(), 2.5);
  EXPECT_EQ(smallKind({}, {1.4, {3, 0, 0}}, 0.6), ObjectKind::kUnknown);
}

TEST(KindBelief, PointsMayBeOfAnotherBody) {
  const ObjectBox person = believedBox(seenFaces({0.8, 0.6, 1.75}, kFine_m), {1.3, {20, 20, 20}});
  EXPECT_EQ(person.kind, ObjectKind::kPedestrian);
}

TEST(KindBelief, NamesNoKindWhileNoneIsLikelyEnough) {
  const ObjectBox unseen = believedBox({}, {3});  // too fast for most walkers, and as good as any speed for a vehicle
  EXPECT_EQ(unseen.kind, ObjectKind::kUnknown);
  EXPECT_GT(unseen.kind_probability, 0.25);  // the largest of four
  EXPECT_LE(unseen.kind_probability, 0.6);
  const ObjectBox fast = believedBox({}, {20});
  EXPECT_EQ(fast.kind, ObjectKind::kCar);  // most of what is that fast
  EXPECT_LT(fast.kind_probability, 0.95);
}

/// A person whose outline bled into what is beside: 2.4 m wide, as a truck is, and as tall as a person.
TEST(KindBelief, IsNotSureOfWhatFitsNoKind) {
  const ObjectBox bled = believedBox(seenFaces({2.4, 2.4, 1.55}, 0.1), {1.6});
  EXPECT_LT(bled.kind_probability, 0.95);
  EXPECT_NE(bled.kind, ObjectKind::kLargeVehicle);
  EXPECT_GT(bled.size_sigma_m.y(), 0.5) << "a person is 1.8 m less wide";
}

TEST(KindBelief, MoreLooksDoNotShrinkTheErrorThatAllShare) {
  const Eigen::Vector3d size_m(4.3, 1.8, 1.5);
  const ObjectBox few = believedBox(seenFaces(size_m, 0.3), {15}), many = believedBox(seenFaces(size_m, 0.01), {15});
  EXPECT_GT(few.size_sigma_m.y(), many.size_sigma_m.y());
  EXPECT_GT(many.size_sigma_m.x(), 0.3);
  EXPECT_GT(many.size_sigma_m.y(), 0.1);
  EXPECT_GT(many.size_sigma_m.z(), 0.08);
  EXPECT_LT(estimateBox(seenFaces(size_m, 0.01), {15}).box().size_sigma_m.y(), 0.02) << "as if looks were independent";
}

TEST(KindBelief, StandardDeviationsHoldTheSpreadBetweenKinds) {
  FaceInformation rear;  // the lower part of something wide
  const BoxFaces faces = StreetByHand::faces({9, 2.35, 3});
  for (const Face face : {kRear, kRight, kLeft, kBottom}) rear.add(Vector6d::Unit(face), faces[face], 0.1);
  const ObjectBox open = believedBox(rear, {10});
  rear.add(Vector6d::Unit(kTop), faces[kTop], 0.1);
  const ObjectBox known = believedBox(rear, {10});
  EXPECT_GT(open.size_sigma_m.z(), 0.5);  // vans are 1 m lower than trucks
  EXPECT_GT(open.size_sigma_m.x(), 2);    // and 4 m shorter
  EXPECT_LT(known.size_sigma_m.z(), 0.5 * open.size_sigma_m.z());
  EXPECT_GT(open.center_sigma_m.x(), 1) << "as its front is hidden, so is its middle";
}

TEST(KindBelief, TheCuboidIsOfTheKindThatIsNamed) {
  FaceInformation rear;  // of something as narrow and low as a car, with one grossly wrong length
  const BoxFaces faces = StreetByHand::faces({8.2, 1.8, 1.5});
  for (int face = 0; face < 6; ++face) rear.add(Vector6d::Unit(face), faces[face], face == kFront ? 0.8 : 0.1);
  const ObjectBox box = believedBox(rear, {10});
  EXPECT_EQ(box.kind, ObjectKind::kCar);
  EXPECT_NEAR(box.size_m.x(), estimateBox(rear, {10}, ObjectKind::kCar).box().size_m.x(), 1e-9);
}

}  // namespace
}  // namespace motorcade
