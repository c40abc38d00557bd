#include "frontend/tracking/duplicate_objects.hpp"

#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

/// A vehicle on which a box of points is followed, from `begin_m` to `end_m` ahead of the world's origin.
struct Seen {
  std::int64_t track;
  double begin_m, end_m;
  double height_m = 1.5, speed_mps = 8, left_m = 0, width_m = 1.8;
};

TrackedObject objectOn(const Seen& seen) {
  TrackedObject object;
  object.track = {seen.track};
  object.T_cam_body = SE3(Eigen::Matrix3d::Identity(), {0.5 * (seen.begin_m + seen.end_m), seen.left_m, 0});
  const Eigen::Vector3d half(0.5 * (seen.end_m - seen.begin_m), 0.5 * seen.width_m, 0.5 * seen.height_m);
  std::int64_t id = 100 * seen.track;
  for (const double x : {-1, 1})
    for (const double y : {-1, 1})
      for (const double z : {-1, 1})
        object.points.push_back({{id++}, half.cwiseProduct(Eigen::Vector3d(x, y, z)), Eigen::Matrix3d::Identity()});
  Vector6d twist = Vector6d::Zero();
  twist[0] = seen.speed_mps;
  object.kinematics = ObjectKinematics(object.T_cam_body, twist, 1e-4 * Matrix12d::Identity());
  return object;
}

/// True when the younger of two objects, one behind the other, is taken for a part of the older.
bool areOne(const Seen& older, const Seen& younger) {
  std::vector<TrackedObject> objects{objectOn(older), objectOn(younger)};
  mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
  EXPECT_NE(objects[0].life.phase(), Phase::kEnded);
  return objects[1].life.phase() == Phase::kEnded;
}

TEST(DuplicateObjects, TwoOnOneVehicleBecomeOneWithThePointsOfBoth) {
  std::vector<TrackedObject> objects{objectOn({1, 10, 12}), objectOn({2, 13, 15})};
  const Eigen::Vector3d p_world = objects[1].T_cam_body * objects[1].points.front().p_body;
  mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
  EXPECT_EQ(objects[0].life.phase(), Phase::kTentative);
  EXPECT_EQ(objects[1].life.phase(), Phase::kEnded);
  ASSERT_EQ(objects[0].points.size(), 16U);
  const BodyPoint* taken = objects[0].find({200});
  ASSERT_NE(taken, nullptr);
  EXPECT_LT((objects[0].T_cam_body * taken->p_body - p_world).norm(), 1e-9);
}

TEST(DuplicateObjects, PatchesOfTheOneThatEndsAreNotTakenForThoseOfTheOther) {
  std::vector<TrackedObject> objects{objectOn({1, 10, 12}), objectOn({2, 13, 15})};
  objects[1].adopt({{{-1}, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()}});
  mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
  EXPECT_EQ(objects[0].points.size(), 16U);
  EXPECT_EQ(objects[0].find({-1}), nullptr);
}

TEST(DuplicateObjects, TheOneThatWasReportedStays) {
  std::vector<TrackedObject> objects{objectOn({1, 10, 12}), objectOn({2, 13, 15})};
  objects[1].life.confirm();
  mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
  EXPECT_EQ(objects[0].life.phase(), Phase::kEnded);
  EXPECT_EQ(objects[1].life.phase(), Phase::kConfirmed);
  EXPECT_EQ(objects[1].points.size(), 16U);
  for (TrackedObject& object : objects = {objectOn({1, 10, 12}), objectOn({2, 13, 15})}) object.life.confirm();
  mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
  EXPECT_EQ(objects[0].life.phase(), Phase::kConfirmed);
  EXPECT_EQ(objects[1].life.phase(), Phase::kEnded);
}

/// The older one's points are ahead of it by now, on what the younger one follows.
TEST(DuplicateObjects, TheYoungerStaysWhereTheOlderHasLeftTheView) {
  const auto endedOne = [](double right_m) {
    std::vector<TrackedObject> objects{objectOn({1, 10, 12}), objectOn({2, 10, 12})};
    objects[0].T_cam_body = SE3(Eigen::Matrix3d::Identity(), {right_m, 0, 6});
    objects[1].T_cam_body = SE3(Eigen::Matrix3d::Identity(), {-4, 0, 6});
    for (TrackedObject& object : objects) object.life.confirm();
    mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
    return objects[0].life.phase() == Phase::kEnded ? 1 : 2;
  };
  EXPECT_EQ(endedOne(-5), 2);
  EXPECT_EQ(endedOne(-6), 1);
}

TEST(DuplicateObjects, TwoWhoWalkAreOneWithinThePlaceOfAPerson) {
  const Seen person{.track = 1, .begin_m = 10, .end_m = 10.4, .speed_mps = 1.4, .width_m = 0.4};
  const auto piece = [](double begin_m, double speed_mps) {
    return Seen{.track = 2, .begin_m = begin_m, .end_m = begin_m + 0.4, .speed_mps = speed_mps, .width_m = 0.4};
  };
  EXPECT_TRUE(areOne(person, piece(10.6, 1.4)));
  EXPECT_FALSE(areOne(person, piece(11.5, 1.4)));
  Seen vehicle = person;
  vehicle.speed_mps = 8;
  EXPECT_TRUE(areOne(vehicle, piece(11.5, 8)));
}

/// One who stands has no speed that tells it from a car in a queue.
TEST(DuplicateObjects, WhoWalksPastOneWhoStandsIsAnother) {
  const Seen walks{.track = 1, .begin_m = 10, .end_m = 10.4, .speed_mps = 1.4, .width_m = 0.4};
  Seen stands{.track = 2, .begin_m = 13, .end_m = 13.4, .speed_mps = 0.1, .width_m = 0.4};
  EXPECT_FALSE(areOne(walks, stands));
  EXPECT_FALSE(areOne(stands, walks));
  stands.begin_m = 10.5, stands.end_m = 10.9;
  EXPECT_TRUE(areOne(walks, stands)) << "an arm";
}

/// Points on a limb give a walker too high a speed for some frames.
TEST(DuplicateObjects, WhoWasBornAsAWalkerIsOneAtAnySpeedOfASmallBody) {
  const auto areOneAt = [](bool born_slow) {
    const auto at = [](std::int64_t track, double begin_m, double speed_mps) {
      return objectOn(
          {.track = track, .begin_m = begin_m, .end_m = begin_m + 0.4, .speed_mps = speed_mps, .width_m = 0.4});
    };
    std::vector<TrackedObject> objects{at(1, 10, 1.9), at(2, 13, 3.2)};
    objects[1].born_slow = born_slow;
    mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
    return objects[1].life.phase() == Phase::kEnded;
  };
  EXPECT_FALSE(areOneAt(true));
  EXPECT_TRUE(areOneAt(false)) << "what rides may be a vehicle's part";
}

TEST(DuplicateObjects, WithoutPointsIsWhereItsPointsWere) {
  const auto areOneAt = [](double ahead_m) {
    std::vector<TrackedObject> objects{objectOn({1, 10, 12}), objectOn({2, ahead_m - 1, ahead_m + 1})};
    objects[0].last_middle_body = objects[0].middle();
    objects[0].points.clear();
    mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
    return objects[1].life.phase() == Phase::kEnded;
  };
  EXPECT_TRUE(areOneAt(12));
  EXPECT_FALSE(areOneAt(40));
}

TEST(DuplicateObjects, WhatIsHigherThanACarMayBeLonger) {
  constexpr double kVan_m = 2.2;
  EXPECT_FALSE(areOne({1, 10, 12}, {2, 17, 18}));
  EXPECT_TRUE(areOne({.track = 1, .begin_m = 10, .end_m = 12, .height_m = kVan_m}, {2, 17, 18}));
  EXPECT_FALSE(areOne({.track = 1, .begin_m = 10, .end_m = 12, .height_m = kVan_m}, {2, 18.5, 20}));
}

TEST(DuplicateObjects, WhatMovesAlikeBehindTheFrontOfALorryIsItsFlank) {
  const Seen lorry{.track = 1, .begin_m = 10, .end_m = 12, .height_m = 2.8};
  EXPECT_TRUE(areOne(lorry, {2, 21, 23}));
  EXPECT_FALSE(areOne(lorry, {2, 23, 25})) << "longer than any lorry";
  EXPECT_FALSE(areOne({.track = 1, .begin_m = 21, .end_m = 23, .height_m = 2.8}, {2, 10, 12})) << "a car before it";
  EXPECT_FALSE(areOne(lorry, {.track = 2, .begin_m = 21, .end_m = 23, .speed_mps = 11}));
}

TEST(DuplicateObjects, AnUncertainDistanceMakesOneOfTwoInALineNotOfTwoAbreast) {
  const auto areOneAfar = [](const Seen& older, const Seen& younger) {
    std::vector<TrackedObject> objects{objectOn(older), objectOn(younger)};
    for (TrackedObject& object : objects) {
      Eigen::Matrix<double, 12, 1> sigma = Eigen::Matrix<double, 12, 1>::Constant(0.01);
      sigma[0] = 0.8;  // along the travel
      object.kinematics =
          ObjectKinematics(object.kinematics.pose(), object.kinematics.twist(), sigma.cwiseAbs2().asDiagonal());
    }
    mergeDuplicates(objects, SeeThrough(SceneMotion{}, test::kRig), test::kRig);
    return objects[1].life.phase() == Phase::kEnded;
  };
  const Seen older{1, 40, 43};
  EXPECT_FALSE(areOne(older, {2, 44, 47}));
  EXPECT_TRUE(areOneAfar(older, {2, 44, 47}));
  EXPECT_FALSE(areOneAfar(older, {.track = 2, .begin_m = 41, .end_m = 44, .left_m = 2.5}));
}

TEST(DuplicateObjects, VehiclesSideBySideOrOfAnotherSpeedAreTwo) {
  EXPECT_FALSE(areOne({1, 10, 12}, {.track = 2, .begin_m = 10, .end_m = 12, .left_m = 3}));
  EXPECT_FALSE(areOne({1, 10, 12}, {.track = 2, .begin_m = 13, .end_m = 15, .speed_mps = 11}));
}

}  // namespace
}  // namespace motorcade
