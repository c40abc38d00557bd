#include "frontend/segmentation/rigid_parts.hpp"

#include <numeric>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::Noise;

constexpr double kSigma_mps = 0.5;  // of each axis of a point's velocity

/// Points with scene flow in a few places.
struct Places {
  std::vector<ScenePoint> points;
  Noise noise;

  explicit Places(std::uint64_t seed) : noise(seed) {}

  /// Points within half a meter of a place, which move as a body with this velocity at the origin and this turn rate.
  void add(const Eigen::Vector3d& place, int count, const Eigen::Vector3d& velocity_mps,
           const Eigen::Vector3d& turn_radps = Eigen::Vector3d::Zero()) {
    for (int i = 0; i < count; ++i) {
      SceneFlow flow;
      flow.p_cam = place + noise.inBox(Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5));
      flow.velocity_mps = velocity_mps + turn_radps.cross(flow.p_cam) +
                          noise.gaussian(Eigen::Vector3d(kSigma_mps, kSigma_mps, kSigma_mps));
      flow.covariance = kSigma_mps * kSigma_mps * Matrix6d::Identity();
      points.push_back({.point = {static_cast<std::int64_t>(points.size())},
                        .uvd_px = Eigen::Vector3d::Zero(),
                        .sigma_px = Eigen::Vector3d::Ones(),
                        .flow = flow});
    }
  }
  std::vector<int> all() const {
    std::vector<int> members(points.size());
    std::iota(members.begin(), members.end(), 0);
    return members;
  }
  std::vector<std::vector<int>> parts() const { return rigidParts(all(), points); }
};

std::vector<int> range(int first, int count) {
  std::vector<int> members(count);
  std::iota(members.begin(), members.end(), first);
  return members;
}

TEST(RigidParts, ACyclistWhoFallsBehindTheBusAheadIsAPartOfItsOwn) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Places street(seed);
    street.add({-1, 0, 16}, 5, {0, 0, 5.6});
    street.add({0, 0, 22}, 7, {0, 0, 8.8});
    const auto parts = street.parts();
    ASSERT_EQ(parts.size(), 2U) << "seed " << seed;
    EXPECT_EQ(std::min(parts[0], parts[1]), range(0, 5));
    EXPECT_EQ(std::max(parts[0], parts[1]), range(5, 7));
  }
}

TEST(RigidParts, ATurningBodyIsOne) {
  int split = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Places street(seed);
    const Eigen::Vector3d turn_radps(0, 0.8, 0);
    street.add({-3, 0, 8}, 6, {2, 0, 9}, turn_radps);
    street.add({-2, 0, 13}, 6, {2, 0, 9}, turn_radps);
    split += street.parts().size() > 1;
  }
  EXPECT_EQ(split, 0) << "its ends differ by four meters per second, across the line between them";
}

TEST(RigidParts, EachOfThreeBodiesIsAPart) {
  Places street(1);
  street.add({0, 0, 10}, 6, {0, 0, 4});
  street.add({0, 0, 15}, 6, {0, 0, 8});
  street.add({0, 0, 20}, 6, {0, 0, 12});
  auto parts = street.parts();
  std::ranges::sort(parts);
  EXPECT_EQ(parts, (std::vector<std::vector<int>>{range(0, 6), range(6, 6), range(12, 6)}));
}

TEST(RigidParts, LimbsAndSinglePointsDoNotPartABody) {
  Places near(1), single(1);
  near.add({0, 0, 10}, 6, {0, 0, 1});
  near.add({0, 0, 11.2}, 6, {0, 0, 4});
  EXPECT_EQ(near.parts().size(), 1U) << "no gap of one and a half meters";
  single.add({0, 0, 10}, 6, {0, 0, 1});
  single.add({0, 0, 15}, 1, {0, 0, 8});
  EXPECT_EQ(single.parts().size(), 1U);
  EXPECT_EQ(Places(1).parts(), (std::vector<std::vector<int>>{{}}));
}

TEST(PooledVelocity, IsTheMeanWeightedByInformationWithoutOutliers) {
  Places street(1);
  street.add({0, 0, 10}, 2, {0, 0, 5});
  street.points[0].flow->velocity_mps = {0, 0, 4};
  street.points[1].flow->velocity_mps = {0, 0, 5};
  street.points[1].flow->covariance *= 0.25;
  const PooledVelocity pooled = poolVelocities(street.all(), street.points, 11.3);
  EXPECT_THAT(pooled.velocity_mps, test::IsNear(Eigen::Vector3d(0, 0, 4.8), 1e-5));
  EXPECT_NEAR(pooled.covariance(2, 2), kSigma_mps * kSigma_mps / 5, 1e-5);

  street.add({0, 0, 10}, 20, {0, 0, 5});
  street.points.back().flow->velocity_mps = {0, 0, 40};
  EXPECT_NEAR(poolVelocities(street.all(), street.points, 11.3).velocity_mps.z(), 5, 3 * kSigma_mps / std::sqrt(20));
}

}  // namespace
}  // namespace motorcade
