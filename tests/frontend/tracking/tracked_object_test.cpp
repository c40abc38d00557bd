#include "frontend/tracking/tracked_object.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TrackedObject objectAt(const std::vector<Eigen::Vector3d>& points_body) {
  TrackedObject object;
  for (std::size_t i = 0; i < points_body.size(); ++i)
    object.points.push_back({{static_cast<std::int64_t>(i)}, points_body[i], Eigen::Matrix3d::Identity()});
  return object;
}

TEST(TrackedObject, StraysStretchTheExtentButNotTheCore) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 20; ++i) points.emplace_back(0.2 * i, 0.1 * i, 0.05 * i);
  points.emplace_back(30, 0, 0);
  const TrackedObject object = objectAt(points);
  EXPECT_NEAR(object.extent(0).sizes().x(), 30, 1e-9);
  EXPECT_LT(object.core(SE3{}).sizes().x(), 4);
}

TEST(TrackedObject, TheMiddleIsTheMedian) {
  EXPECT_EQ(objectAt({{0, 0, 0}, {1, 2, 9}, {40, 3, 1}}).middle(), Eigen::Vector3d(1, 2, 1));
  EXPECT_EQ(objectAt({}).middle(), Eigen::Vector3d::Zero());
}

TEST(TrackedObject, TheCoreOfFewPointsHoldsThemAllWhereItIsMovedTo) {
  const TrackedObject object = objectAt({{0, 0, 0}, {1, 2, 3}, {2, 1, 0}});
  const Eigen::AlignedBox3d core = object.core(SE3(Eigen::Matrix3d::Identity(), {10, 0, 0}));
  EXPECT_EQ(core.min(), Eigen::Vector3d(10, 0, 0));
  EXPECT_EQ(core.max(), Eigen::Vector3d(12, 2, 3));
}

}  // namespace
}  // namespace motorcade
