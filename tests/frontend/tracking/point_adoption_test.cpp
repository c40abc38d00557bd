#include "frontend/tracking/point_adoption.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::kRig;

/// A car 12 m ahead with points over two meters of its length, and points of the scene that may join it. The camera
/// stands at the world's origin.
struct CarWithPoints {
  TrackedObject object;
  SceneMotion scene;
  std::vector<bool> taken;

  explicit CarWithPoints(double speed_mps = 10) {
    Eigen::Matrix3d upright;  // columns: ahead = camera's z, left = -x, up = -y
    upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    object.T_cam_body = SE3(upright, {1, 1, 12});
    Vector6d twist;
    twist << speed_mps, 0, 0, 0, 0, 0;
    object.kinematics = ObjectKinematics(object.T_cam_body, twist, 0.01 * Matrix12d::Identity());
    for (const double x_m : {-1.0, 0.0, 1.0})
      object.points.push_back(
          {{static_cast<std::int64_t>(1000 + x_m)}, {x_m, 0, 0}, 1e-4 * Eigen::Matrix3d::Identity()});
  }

  /// A point of the scene at `p_body`, moving as the body does there.
  ScenePoint& see(const Eigen::Vector3d& p_body) {
    ScenePoint p{.point = {static_cast<std::int64_t>(scene.points.size())},
                 .uvd_px = *kRig.project(object.T_cam_body * p_body),
                 .sigma_px = Eigen::Vector3d::Constant(0.05),
                 .flow = {}};
    p.flow = SceneFlow{.p_cam = object.T_cam_body * p_body,
                       .velocity_mps = object.velocityAt_mps(p_body),
                       .covariance = 0.01 * Matrix6d::Identity(),
                       .static_chi2 = 100,
                       .moving_chi2 = 5};
    scene.points.push_back(p);
    taken.push_back(false);
    return scene.points.back();
  }
  /// True when the object takes the newest point, from the whole scene or from a component of all its points.
  bool takes(bool from_segment = false) {
    MotionComponent component;
    for (int i = 0; i < static_cast<int>(scene.points.size()); ++i) component.points.push_back(i);
    PointAdoption adopt(kRig);
    adopt(object, scene, from_segment ? &component : nullptr, SE3{}, taken);
    return object.find(scene.points.back().point) != nullptr;
  }
};

/// True when a car takes a point at `p_body` after `change` was made to it.
template <class Change>
bool takesAfter(const Change& change, const Eigen::Vector3d& p_body = {0.5, 0.2, 0.3}) {
  CarWithPoints car;
  change(car.see(p_body));
  return car.takes();
}

TEST(PointAdoption, TakesThePointsWithinTheObjectThatMoveWithIt) {
  CarWithPoints car;
  car.see({0.5, 0.2, 0.3});
  car.see({-0.5, -0.2, 0.1});
  EXPECT_TRUE(car.takes());
  ASSERT_EQ(car.object.points.size(), 5U);
  EXPECT_TRUE(std::ranges::is_sorted(car.object.points, {}, &BodyPoint::point));
  EXPECT_THAT(car.object.find({0})->p_body, IsNear(Eigen::Vector3d(0.5, 0.2, 0.3), 1e-9));
  EXPECT_EQ(car.taken, std::vector<bool>({true, true}));
}

TEST(PointAdoption, LeavesWhatIsTooFarAwayToKnowWhere) {
  // The velocity of a point without parallax fits every body, and its depth every place along its ray.
  const auto at_infinity = [](ScenePoint& p) {
    p.uvd_px.z() = 0.01;
    p.sigma_px.z() = 0.3;
    p.flow->covariance *= 1e6;
  };
  EXPECT_FALSE(takesAfter(at_infinity));
  CarWithPoints car;
  at_infinity(car.see({0.5, 0.2, 0.3}));
  EXPECT_FALSE(car.takes(true));
}

TEST(PointAdoption, LeavesWhatBelongsToAnotherObject) {
  CarWithPoints car;
  car.see({0.5, 0.2, 0.3});
  car.taken[0] = true;
  EXPECT_FALSE(car.takes());
  EXPECT_EQ(car.object.points.size(), 3U);
}

TEST(PointAdoption, LeavesWhatDoesNotShowThatItMovesWithTheBody) {
  EXPECT_TRUE(takesAfter([](ScenePoint&) {}));
  EXPECT_FALSE(takesAfter([](ScenePoint& p) { p.flow.reset(); }));
  EXPECT_FALSE(takesAfter([](ScenePoint& p) { p.flow->velocity_mps.z() -= 3; }));  // slower than the body by 3 m/s
  EXPECT_FALSE(takesAfter([](ScenePoint& p) { p.flow->static_chi2 = 15; }));       // as good as at rest
  EXPECT_FALSE(takesAfter([](ScenePoint& p) { p.label = PointLabel::kGround; }));
  EXPECT_FALSE(takesAfter([](ScenePoint& p) { p.ambiguous = true; }));
}

TEST(PointAdoption, ASlowObjectTakesNone) {
  CarWithPoints slow(0.5);
  slow.see({0.5, 0.2, 0.3});
  EXPECT_FALSE(slow.takes());
}

TEST(PointAdoption, WhatLiesApartJoinsOnlyFromTheSegmentThatWasMatched) {
  for (const bool from_segment : {false, true}) {
    CarWithPoints car;
    car.see({-3, 0, 0.3});  // two meters behind the points that are known, within the length of a car
    EXPECT_EQ(car.takes(from_segment), from_segment);
  }
  CarWithPoints wide;
  wide.see({0, 5, 0.3});
  EXPECT_FALSE(wide.takes(true));  // no vehicle is so wide
}

TEST(PointAdoption, AnUncertainDepthJoinsWhatIsAheadNotWhatIsInTheNextLane) {
  const auto takesUncertain = [](const Eigen::Vector3d& p_body, double sigma_px) {
    CarWithPoints car;
    car.object.points.push_back({{2000}, {0, -1.6, 0}, 1e-4 * Eigen::Matrix3d::Identity()});  // on its other side
    car.see(p_body).sigma_px.z() = sigma_px;
    return car.takes();
  };
  EXPECT_FALSE(takesUncertain({3, 0, 0}, 0.05));
  EXPECT_TRUE(takesUncertain({3, 0, 0}, 2));
  EXPECT_FALSE(takesUncertain({0, 1.9, 0}, 2));
}

TEST(PointAdoption, ALongVehicleIsFoundStepByStepUpToTheLengthOfALorry) {
  CarWithPoints car;
  double reached_m = 1;
  for (double x_m = 1.5; x_m < 20; x_m += 0.5) {
    car.see({x_m, 0, 0.3});
    if (car.takes()) reached_m = x_m;
  }
  EXPECT_GT(reached_m, 10);
  EXPECT_LT(reached_m, 14);
}

/// A person who walks beside another one, at the same speed.
struct PersonWithPoints : CarWithPoints {
  PersonWithPoints() : CarWithPoints(1.5) {
    object.points.clear();
    for (const double z_m : {0.0, 0.8})
      for (const double y_m : {-0.2, 0.2})
        object.points.push_back(
            {{1000 + std::ssize(object.points)}, {0, y_m, z_m}, 1e-4 * Eigen::Matrix3d::Identity()});
    object.life.observe();
  }
};

TEST(PointAdoption, APersonTakesWhatIsOnOnePerson) {
  PersonWithPoints person;
  person.see({0.1, 0.3, 1.2});
  EXPECT_TRUE(person.takes()) << "the head";
  for (const bool from_segment : {false, true}) {
    PersonWithPoints beside;
    beside.see({0, 1, 0.5});
    EXPECT_FALSE(beside.takes(from_segment)) << "another person";
  }
}

/// True when a person takes a point two meters aside. One frame of the person was seen, too few to know the size.
bool takesBeside(bool wall_between) {
  PersonWithPoints person;
  person.object.life = LifeCycle{};
  for (int i = 0; i < 4; ++i) person.see({wall_between ? 8.0 : 0.0, 2 + 0.1 * i, 0.2 * i}).flow.reset();
  person.see({0, 2, 0.5});
  const std::int64_t beside = person.scene.points.back().point.value;
  for (const BodyPoint& p : std::vector(person.object.points)) {
    person.see(p.p_body).point = p.point;
    person.taken.back() = true;
  }
  person.takes(true);
  return person.object.find({beside}) != nullptr;
}

TEST(PointAdoption, WhatTheBackgroundPartsBelongsToAnother) {
  EXPECT_TRUE(takesBeside(false));
  EXPECT_FALSE(takesBeside(true));
}

/// Points that joined a car although they lie on what drives five meters behind it.
TEST(OtherBodies, PointsThatMoveApartFromMostAreDisowned) {
  for (const double slower_mps : {0.0, 3.0}) {
    CarWithPoints car;
    car.object.points.clear();
    for (const double y_m : {-0.6, -0.3, 0.0, 0.3, 0.6}) car.see({0, y_m, 0.3});
    for (const double y_m : {-0.2, 0.0, 0.2}) car.see({-5, y_m, 0.3}).flow->velocity_mps.z() -= slower_mps;
    for (const ScenePoint& p : car.scene.points)
      car.object.points.push_back({p.point, Eigen::Vector3d::Zero(), 1e-4 * Eigen::Matrix3d::Identity()});
    disownOtherBodies(car.object, car.scene);
    EXPECT_EQ(car.object.points.size(), slower_mps > 0 ? 5U : 8U);
    EXPECT_TRUE(car.object.find({0}));
  }
}

}  // namespace
}  // namespace motorcade
