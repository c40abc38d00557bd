#include "frontend/segmentation/motion_segmenter.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

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
  std::vector<MotionComponent> components() {
    return MotionSegmenter({}, kRig)(points, std::vector<bool>(points.size(), false), GroundPlane{}, kSpeed_mps);
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

}  // namespace
}  // namespace motorcade
