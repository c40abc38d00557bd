#include "frontend/segmentation/vehicles_abreast.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

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
