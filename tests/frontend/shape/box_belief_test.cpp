#include "frontend/shape/box_belief.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/frontend/shape/street_by_hand.hpp"

namespace motorcade {
namespace {

using test::StreetByHand;

FaceInformation seen(const Eigen::Vector3d& size_m, double sigma_m) {
  const BoxFaces faces = StreetByHand::faces(size_m);
  FaceInformation information;
  for (int face = 0; face < 6; ++face) information.add(Vector6d::Unit(face), faces[face], sigma_m);
  return information;
}

TEST(BoxBelief, KindsAreToldBySizeAndSpeed) {
  const auto kind = [](const Eigen::Vector3d& size_m, double speed_mps) {
    return estimateBox(seen(size_m, 0.1), {speed_mps}).kind;
  };
  EXPECT_EQ(kind({4.3, 1.8, 1.5}, 15), ObjectKind::kCar);
  EXPECT_EQ(kind({5.4, 2.0, 2.2}, 15), ObjectKind::kCar);  // a van
  EXPECT_EQ(kind({11, 2.5, 3.3}, 15), ObjectKind::kLargeVehicle);
  EXPECT_EQ(kind({1.8, 0.6, 1.7}, 6), ObjectKind::kTwoWheeler);
  EXPECT_EQ(kind({0.8, 0.6, 1.75}, 1.5), ObjectKind::kPedestrian);
  EXPECT_EQ(kind({1.3, 0.6, 1.75}, 5), ObjectKind::kTwoWheeler);  // too short for one, too fast for a walker
  const BoxEstimate fast = estimateBox(seen({1.2, 0.65, 1.75}, 0.3), {10}),
                    slow = estimateBox(seen({1.2, 0.65, 1.75}, 0.3), {1});
  EXPECT_EQ(fast.kind, ObjectKind::kTwoWheeler);  // nobody runs that fast
  EXPECT_EQ(slow.kind, ObjectKind::kPedestrian);
}

TEST(BoxBelief, WithoutEvidenceThereIsACarOfUsualSize) {
  const BoxEstimate estimate = estimateBox({}, {10});
  EXPECT_EQ(estimate.kind, ObjectKind::kCar);
  EXPECT_NEAR(estimate.box().size_m.x(), 4, 0.5);
  EXPECT_GT(estimate.box().center_sigma_m.x(), 1);
}

TEST(BoxBelief, HiddenFacesComeFromTheKindAndGrowSureWhenTheyAreSeen) {
  FaceInformation rear;
  rear.add(Vector6d::Unit(kRear), -0.2, 0.1);
  for (const Face face : {kRight, kLeft}) rear.add(Vector6d::Unit(face), face == kLeft ? 0.9 : -0.9, 0.05);
  rear.add(Vector6d::Unit(kBottom), -0.8, 0.05);
  rear.add(Vector6d::Unit(kTop), 0.7, 0.05);
  const ObjectBox hidden = estimateBox(rear, {10}).box();
  EXPECT_NEAR(hidden.size_m.x(), 4.1, 0.2);
  EXPECT_NEAR(hidden.center_body.x(), -0.2 + 0.5 * hidden.size_m.x(), 0.1);
  EXPECT_GT(hidden.size_sigma_m.x(), 0.3);
  EXPECT_LT(hidden.size_sigma_m.y(), 0.1);
  rear.add(Vector6d::Unit(kFront), 4.5, 0.1);
  const ObjectBox found = estimateBox(rear, {10}).box();
  EXPECT_NEAR(found.size_m.x(), 4.7, 0.15);
  EXPECT_LT(found.size_sigma_m.x(), 0.2);
}

/// The rear of a bus, of whose flank some meters were seen now and then.
TEST(BoxBelief, AReachExtendsABodyButDoesNotHoldIt) {
  const auto length_of = [](double reach_m) {
    FaceInformation rear = seen({11, 2.5, 3.3}, 0.1);
    rear.H.row(kFront).setZero(), rear.H.col(kFront).setZero(), rear.b[kFront] = 0;
    rear.c -= std::pow(StreetByHand::faces({11, 2.5, 3.3})[kFront] / 0.1, 2);
    if (reach_m > 0) rear.addReach(kFront, rear.b[kRear] / rear.H(kRear, kRear) + reach_m, 0.05);
    return estimateBox(rear, {10}).box().size_m.x();
  };
  const double unseen_m = length_of(0);
  EXPECT_GT(unseen_m, 7);
  EXPECT_NEAR(length_of(3), unseen_m, 1e-9);
  EXPECT_NEAR(length_of(14), 14, 0.1);
}

TEST(BoxBelief, AReachThatPushesOneFaceMayPushAnother) {
  FaceInformation ends;
  ends.addReach(kFront, 6, 0.05);
  ends.addReach(kRear, 1, 0.05);  // within the body while it is around its origin
  const BoxEstimate estimate = estimateBox(ends, {10}, ObjectKind::kPedestrian);
  EXPECT_NEAR(estimate.faces[kFront], 6, 0.3);
  EXPECT_LT(estimate.faces[kRear], 1.3);
}

TEST(BoxBelief, AKnownKindClosesWhatIsHidden) {
  FaceInformation rear;
  for (const Face face : {kRear, kBottom}) rear.add(Vector6d::Unit(face), -0.8, 0.1);
  for (const auto& [kind, length_m] : {std::pair(ObjectKind::kPedestrian, 0.84), {ObjectKind::kLargeVehicle, 10.0}}) {
    const BoxEstimate estimate = estimateBox(rear, {10}, kind);
    EXPECT_EQ(estimate.kind, kind);
    EXPECT_NEAR(estimate.box().size_m.x(), length_m, 0.25 * length_m) << "the origin tells a little, too";
  }
  EXPECT_EQ(estimateBox(rear, {10}, ObjectKind::kUnknown).kind, ObjectKind::kCar);
}

TEST(BoxBelief, ThePossibleVolumeHoldsWhatIsNotRuledOut) {
  const BoxEstimate unknown = estimateBox({}, {5}), known = estimateBox(seen({4.3, 1.8, 1.5}, 0.05), {15});
  EXPECT_GT((unknown.possible_most - unknown.possible_least).z(), 2);  // a large vehicle is not ruled out
  EXPECT_LT((known.possible_most - known.possible_least).z(), 1.7);
  EXPECT_TRUE((unknown.possible_least.array() <= unknown.usual_least.array()).all());
  EXPECT_TRUE((unknown.possible_most.array() >= unknown.usual_most.array()).all());
}

TEST(BoxBelief, TheVolumeOfWhatIsKnownToWalkIsAPersons) {
  const BoxEstimate any = estimateBox({}, {1.4}), person = estimateBox({}, {1.4}, ObjectKind::kPedestrian);
  EXPECT_GT((any.usual_most - any.usual_least).x(), 4);
  EXPECT_LT((person.usual_most - person.usual_least).x(), 1);
  EXPECT_LT((person.possible_most - person.possible_least).y(), (any.possible_most - any.possible_least).y() - 0.8);
}

TEST(FaceInformation, MovesWithTheBodyFrame) {
  const Eigen::Vector3d shift(0.5, -0.2, 0.1), size_m(4, 1.7, 1.5);
  const FaceInformation moved = seen(size_m, 0.2).shifted(shift);
  FaceInformation expected;
  const BoxFaces faces = StreetByHand::faces(size_m);
  for (int face = 0; face < 6; ++face) expected.add(Vector6d::Unit(face), faces[face] + shift[face / 2], 0.2);
  EXPECT_LT((moved.H - expected.H).norm(), 1e-9);
  EXPECT_LT((moved.b - expected.b).norm(), 1e-9);
  EXPECT_NEAR(moved.c, expected.c, 1e-9);

  FaceInformation reach, beyond;
  reach.addReach(kLeft, 0.9, 0.2), beyond.addReach(kLeft, 0.9 + shift.y(), 0.2);
  EXPECT_EQ(reach.shifted(shift).reach_weight, beyond.reach_weight);
  EXPECT_LT((reach.shifted(shift).reach_sum - beyond.reach_sum).norm(), 1e-9);
}

TEST(BoxBelief, VolumesReachOverWhatIsKnownOfTheBody) {
  const BoxEstimate before = estimateBox(seen({4.3, 1.8, 1.5}, 0.05), {15});
  BoxEstimate after = before;
  after.reach({Eigen::Vector3d(-9, -3, 0), Eigen::Vector3d(1, -4, 0.1)});  // nothing is sure of its width
  EXPECT_EQ(after.usual_least.x(), -9);
  EXPECT_EQ(after.possible_least.x(), -9);
  EXPECT_EQ(after.usual_most, before.usual_most);
  EXPECT_EQ(after.possible_most, before.possible_most);
  EXPECT_EQ(after.usual_least.tail<2>(), before.usual_least.tail<2>());
  EXPECT_EQ(after.faces, before.faces);
}

}  // namespace
}  // namespace motorcade
