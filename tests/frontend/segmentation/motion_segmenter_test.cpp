#include "frontend/segmentation/motion_segmenter.hpp"

#include <algorithm>
#include <queue>

#include <gtest/gtest.h>

#include "tests/support/empty_circle.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using Points = std::vector<Eigen::Vector2d>;
using Components = std::vector<std::vector<int>>;

Points onPixelGrid(int count, test::Noise& noise) {
  Points points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(std::round(noise.uniform(0, 16 * 500)) / 16, std::round(noise.uniform(0, 16 * 180)) / 16);
  return points;
}

/// Components by breadth-first search, in the order that the graph promises.
template <class Predicate>
Components search(int count, const std::set<std::array<int, 2>>& edges, const Predicate& together) {
  std::vector<bool> seen(static_cast<std::size_t>(count), false);
  Components components;
  for (int start = 0; start < count; ++start) {
    if (seen[start]) continue;
    std::vector<int> members;
    std::queue<int> open({start});
    seen[start] = true;
    while (!open.empty()) {
      const int i = open.front();
      open.pop();
      members.push_back(i);
      for (int j = 0; j < count; ++j) {
        if (seen[j] || !edges.contains({std::min(i, j), std::max(i, j)}) || !together(i, j)) continue;
        seen[j] = true;
        open.push(j);
      }
    }
    std::ranges::sort(members);
    components.push_back(members);
  }
  return components;
}

TEST(MotionGraph, ComponentsAreThoseOfTheTriangulationByItsDefinition) {
  int compared = 0, several = 0;
  for (std::uint64_t seed = 0; seed < 15; ++seed) {
    test::Noise noise(seed);
    const int count = 30 + 2 * static_cast<int>(seed);
    const Points points = onPixelGrid(count, noise);
    std::vector<test::Grid> grid;
    std::vector<double> speed;
    for (const auto& p : points) {
      grid.push_back(test::onGrid(p));
      speed.push_back(std::floor(p.x() / 100) + noise.uniform(0, 1.2));  // neighboring stripes sometimes touch
    }
    const auto edges = test::delaunayEdgesByDefinition(grid);
    if (!edges) continue;  // no unique triangulation to compare with
    const auto together = [&](int i, int j) { return std::abs(speed[i] - speed[j]) < 0.5; };
    const Components expected = search(count, *edges, together);
    EXPECT_EQ(cutDelaunayComponents(points, together), expected) << "seed " << seed;
    ++compared;
    several += expected.size() > 3 && expected.size() < points.size() / 2;
  }
  EXPECT_GE(compared, 10);  // degenerate draws are rare, ...
  EXPECT_GE(several, 5);    // ... and the predicate neither cuts nor keeps all
}

TEST(MotionGraph, AClusterBetweenOthersIsCutOutAndCoincidentPointsStayTogether) {
  const Points points{{10, 10}, {50, 10}, {50, 10}, {10, 40}, {52, 40}, {10, 10.01}, {90, 12}, {91, 41}};
  const std::vector<int> body{0, 1, 2, 0, 1, 3, 4, 4};  // points 2 and 5 lie at the pixel of another body
  const auto together = [&](int i, int j) { return body[i] == body[j]; };
  const Components expected{{0, 3, 5}, {1, 2, 4}, {6, 7}};
  EXPECT_EQ(cutDelaunayComponents(points, together), expected);
}

TEST(MotionGraph, NoPointsHaveNoComponents) {
  const auto never = [](int, int) { return false; };
  EXPECT_TRUE(cutDelaunayComponents({}, never).empty());
  EXPECT_EQ(cutDelaunayComponents(Points{{1, 1}, {5, 5}}, never).size(), 2U);
}

constexpr double kSpeed_mps = 13;  // of the camera

using test::kRig;
using test::Noise;

/// Points with scene flow: bodies in front of a house wall.
struct Street {
  std::vector<ScenePoint> points;
  std::vector<int> body;  // of each point
  int bodies = 0;
  Noise noise;

  explicit Street(std::uint64_t seed) : noise(seed) {}

  /// `count` points in a box about `center`; returns the body's number. The velocities scatter by their covariance.
  int add(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size, const Eigen::Vector3d& velocity_mps,
          int count, double sigma_mps = 0.3) {
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d p = center + noise.inBox(-half_size, half_size);
      const Eigen::Vector3d uvd = *kRig.project(p), sigma(0.4 * sigma_mps, 0.4 * sigma_mps, sigma_mps);
      SceneFlow flow{.p_cam = p,
                     .velocity_mps = velocity_mps + noise.gaussian(sigma),
                     .covariance = Matrix6d::Zero(),
                     .observations = 6};
      flow.covariance.topLeftCorner<3, 3>() = test::triangulationCovariance(uvd) / 6;
      flow.covariance.bottomRightCorner<3, 3>() = sigma.cwiseAbs2().asDiagonal();
      points.push_back({.point = {static_cast<std::int64_t>(points.size())},
                        .uvd_px = uvd,
                        .sigma_px = test::kObservationSigma_px,
                        .flow = flow});
      body.push_back(bodies);
    }
    return bodies++;
  }
  std::vector<MotionComponent> components(double camera_speed_mps = kSpeed_mps) {
    return MotionSegmenter({}, kRig)(points, std::vector<bool>(points.size(), false), GroundPlane{}, camera_speed_mps);
  }
  /// Share of a body's points with a label.
  double share(int of_body, PointLabel label) const {
    int all = 0, labeled = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      all += body[i] == of_body;
      labeled += body[i] == of_body && points[i].label == label;
    }
    return static_cast<double>(labeled) / all;
  }
  /// The body most of a component's points belong to, and whether they all do.
  std::pair<int, bool> ownerOf(const MotionComponent& component) const {
    std::vector<int> votes(static_cast<std::size_t>(bodies), 0);
    for (const int i : component.points) ++votes[body[i]];
    const auto best = std::ranges::max_element(votes);
    return {static_cast<int>(best - votes.begin()), *best == static_cast<int>(component.points.size())};
  }
};

const Eigen::Vector3d kCar(0.9, 0.6, 0.8);  // half the size of a car's visible part

TEST(MotionSegmenter, NeighborsOfDifferentSpeedAParkedCarAndTheWallAreToldApart) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Street street(seed);
    const int fast = street.add({-1.5, 0.8, 14}, kCar, {0, 0, 12}, 15),
              slow = street.add({1.5, 0.8, 14}, kCar, {0, 0, 6}, 15);
    const int parked = street.add({5, 0.8, 16}, kCar, {0, 0, 0}, 15),
              wall = street.add({0, -1, 24}, {12, 2, 0.5}, {0, 0, 0}, 80);
    const auto components = street.components();
    // One point in a hundred has a velocity that its neighbors do not share, by the gate, and stays alone and unknown.
    EXPECT_GT(street.share(fast, PointLabel::kMoving), 0.9);
    EXPECT_GT(street.share(slow, PointLabel::kMoving), 0.9);
    EXPECT_EQ(street.share(parked, PointLabel::kMoving), 0);
    EXPECT_EQ(street.share(wall, PointLabel::kMoving), 0);
    EXPECT_GT(street.share(parked, PointLabel::kStatic), 0.8);
    int moving = 0;
    for (const auto& s : components) {
      if (s.label != PointLabel::kMoving) continue;
      ++moving;
      const auto [owner, pure] = street.ownerOf(s);
      EXPECT_TRUE(pure) << "seed " << seed;
      EXPECT_NEAR(s.velocity_mps.z(), owner == fast ? 12 : 6, 0.4);  // 0.3 m/s over the root of 15 points, five sigmas
    }
    EXPECT_EQ(moving, 2) << "seed " << seed;
  }
}

/// Each of the walker's points is joined to the wall by the tolerance, and differs from rest by more than the noise.
TEST(MotionSegmenter, AWalkerBeforeAWallOfAlmostItsVelocityMoves) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Street street(seed);
    const int walker = street.add({-3, 0.7, 14}, {0.25, 0.8, 0.2}, {0, 0, 1.5}, 12, 0.25),
              wall = street.add({-3, 0, 14.8}, {3, 1.5, 0.1}, {0, 0, 0}, 60, 0.25);
    street.components(3);
    EXPECT_GT(street.share(walker, PointLabel::kMoving), 0.6) << "seed " << seed;
    EXPECT_EQ(street.share(wall, PointLabel::kMoving), 0) << "seed " << seed;
  }
}

TEST(MotionSegmenter, AFarClusterOfUncertainVelocityIsUnknown) {
  Street street(1);
  const int far = street.add({2, 0.5, 60}, kCar, {0, 0, 8}, 8, 3.5);
  const auto components = street.components();
  EXPECT_EQ(street.share(far, PointLabel::kUnknown), 1);
  for (const auto& s : components) EXPECT_EQ(s.label, PointLabel::kUnknown);
}

TEST(MotionSegmenter, PointsOfHopelessUncertaintyAreNoVertices) {
  Street street(1);
  street.add({2, 0.5, 60}, kCar, {0, 0, 8}, 8, 12);
  EXPECT_TRUE(street.components().empty());
}

TEST(MotionSegmenter, GroundPointsAreInNoSegment) {
  Street street(2);
  street.add({0, 0.8, 14}, kCar, {0, 0, 12}, 15);
  const int ground = street.add({0, 1.6, 13}, {1, 0.02, 1}, {0, 0, 12}, 15);  // a shadow travels with the car
  for (std::size_t i = 0; i < street.points.size(); ++i)
    if (street.body[i] == ground) street.points[i].label = PointLabel::kGround;
  const auto components = street.components();
  ASSERT_FALSE(components.empty());
  for (const auto& s : components)
    for (const int i : s.points) EXPECT_NE(street.body[i], ground);
  EXPECT_EQ(street.share(ground, PointLabel::kGround), 1);
}

TEST(MotionSegmenter, CarsOfEqualVelocityFiveMetersApartAreTwo) {
  Street street(3);
  const int left = street.add({-3.4, 0.8, 14}, kCar, {0, 0, 10}, 15),
            right = street.add({3.4, 0.8, 14}, kCar, {0, 0, 10}, 15);
  int moving = 0;
  for (const auto& s : street.components()) {
    moving += s.label == PointLabel::kMoving;
    EXPECT_TRUE(street.ownerOf(s).second);
  }
  EXPECT_EQ(moving, 2);
  EXPECT_EQ(street.share(left, PointLabel::kMoving), 1);
  EXPECT_EQ(street.share(right, PointLabel::kMoving), 1);
}

/// A lead car beside the end of a long truck: their points are nearer than the largest gap on one vehicle, and their
/// velocities differ by less than a tight turn explains.
TEST(MotionSegmenter, VehiclesOfAQueueAreToldApart) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Street street(seed);
    const int car = street.add({0.4, 0.8, 10}, kCar, {0, 0, 9}, 20, 0.15),
              truck = street.add({2.4, 0, 17}, {0.2, 1.4, 6.5}, {0, 0, 6.3}, 300, 0.15);
    int of_car = 0, moving = 0;
    for (const MotionComponent& component : street.components()) {
      if (component.label != PointLabel::kMoving) continue;
      ++moving;
      of_car += street.ownerOf(component).first == car;
    }
    EXPECT_GT(street.share(car, PointLabel::kMoving), 0.7) << "seed " << seed;
    EXPECT_GT(street.share(truck, PointLabel::kMoving), 0.8) << "seed " << seed;
    EXPECT_EQ(of_car, 1) << "seed " << seed;
    EXPECT_LE(moving, 3) << "seed " << seed;
  }
}

/// A cyclist behind a car that drives away from her. Single points are too noisy to tell.
TEST(MotionSegmenter, BodiesThatPartAreToldApartByAllTheirPoints) {
  Street street(1);
  street.add({0.2, 0.6, 17}, {0.2, 0.6, 0.1}, {0, 0, 5}, 8, 1.2);
  street.add({0.6, 0.8, 19}, {0.8, 0.6, 0.1}, {0, 0, 9}, 12, 1.2);
  for (const auto& s : street.components()) EXPECT_TRUE(street.ownerOf(s).second);
}

/// A long house that seems to move, by a wrong turn of the camera say, and not by its noise.
TEST(MotionSegmenter, HalfOfAHouseIsNoVehicle) {
  Street street(5);
  const int house = street.add({-6, 0, 20}, {0.2, 1.5, 12}, {0, 0, 3.5}, 150);
  street.components();
  EXPECT_EQ(street.share(house, PointLabel::kMoving), 0);
}

TEST(MotionSegmenter, WhatFliesOrRisesIsNoVehicle) {
  Street street(4);
  const int bird = street.add({0, -5, 14}, {0.3, 0.2, 0.3}, {3, 0, 5}, 8),
            leaf = street.add({6, 0.5, 14}, {0.3, 0.2, 0.3}, {0, -6, 1}, 8);
  street.components();
  EXPECT_EQ(street.share(bird, PointLabel::kMoving), 0);
  EXPECT_EQ(street.share(leaf, PointLabel::kMoving), 0);
}

TEST(MotionSegmenter, AnEndThatBreaksTheGeometryIsCutFromOneThatKeepsIt) {
  Street street(5);
  street.add({0, 0.8, 14}, kCar, {0, 0, 10}, 20);
  std::vector<bool> violates(street.points.size(), false);
  std::fill(violates.begin(), violates.begin() + 10, true);
  const auto components = MotionSegmenter({}, kRig)(street.points, violates, GroundPlane{}, kSpeed_mps);
  EXPECT_GE(components.size(), 2U);
  for (const auto& s : components)
    for (const int i : s.points) EXPECT_EQ(violates[i], violates[s.points.front()]);
}

constexpr double kWidth_m = 2.8;

/// A component that drives ahead, of points around some positions.
struct Traffic {
  SceneMotion scene;
  MotionComponent component;
  test::Noise noise{1};

  void add(const Eigen::Vector3d& middle_cam, int count, double position_sigma_m = 0.05) {
    for (int i = 0; i < count; ++i) {
      SceneFlow flow;
      flow.p_cam = middle_cam + noise.inBox({-1, -1, -2}, {1, 1, 2});
      flow.velocity_mps = {0, 0, 12};
      flow.covariance.setIdentity();
      flow.covariance.topLeftCorner<3, 3>() *= position_sigma_m * position_sigma_m;
      component.points.push_back(static_cast<int>(scene.points.size()));
      scene.points.push_back({.point = {static_cast<std::int64_t>(scene.points.size())},
                              .uvd_px = Eigen::Vector3d::Zero(),
                              .sigma_px = Eigen::Vector3d::Ones(),
                              .flow = flow});
    }
    component.velocity_mps = {0.5, 0, 12};
  }
  std::vector<MotionComponent> split() const { return splitAbreast(component, component.points, scene, kWidth_m); }
};

TEST(VehiclesAbreast, ThreeTrucksSideBySideAreThree) {
  Traffic traffic;
  const std::vector<Eigen::Vector3d> middles{{3.2, 0, 20}, {-3.2, 0, 12}, {0, 0, 19}};
  for (const auto& middle : middles) traffic.add(middle, 60);
  const auto vehicles = traffic.split();
  ASSERT_EQ(vehicles.size(), 3U);
  std::size_t points = 0;
  for (const auto& vehicle : vehicles) {
    EXPECT_EQ(vehicle.points.size(), 60U);
    EXPECT_EQ(vehicle.velocity_mps, traffic.component.velocity_mps);
    EXPECT_TRUE(std::ranges::any_of(middles, [&](const auto& m) { return (m - vehicle.centroid_cam).norm() < 0.6; }))
        << vehicle.centroid_cam;
    points += vehicle.points.size();
  }
  EXPECT_EQ(points, traffic.component.points.size());
}

TEST(VehiclesAbreast, ALongTruckIsOne) {
  Traffic traffic;
  for (const double z_m : {8.0, 12.0, 16.0}) traffic.add({-3, 0, z_m}, 20);
  const auto vehicles = traffic.split();
  ASSERT_EQ(vehicles.size(), 1U);
  EXPECT_EQ(vehicles[0].points, traffic.component.points);
}

TEST(VehiclesAbreast, NoiseOfDistantPointsIsNoWidth) {
  Traffic near, far;
  for (auto* traffic : {&near, &far}) {
    const double sigma_m = traffic == &far ? 1.0 : 0.05;
    traffic->add({-1.2, 0, 50}, 10, sigma_m);
    traffic->add({1.2, 0, 50}, 10, sigma_m);
  }
  EXPECT_EQ(near.split().size(), 2U);
  EXPECT_EQ(far.split().size(), 1U);
}

TEST(VehiclesAbreast, NothingIsSplitOfNothing) {
  const Traffic traffic;
  EXPECT_TRUE(traffic.split().empty());
}

}  // namespace
}  // namespace motorcade
