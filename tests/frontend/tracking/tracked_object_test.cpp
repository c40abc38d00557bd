#include "frontend/tracking/tracked_object.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::kRig;

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

TEST(TrackedObject, APointInBodyAxesHasTheCovarianceOfItsTriangulation) {
  Eigen::Matrix3d upright;  // columns: ahead = camera's z, left = -x, up = -y
  upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const SE3 T_cam_body(upright, {1, 1, 12});
  const Eigen::Vector3d p_body(0.5, 0.2, 0.3);
  const ScenePoint seen{
      .point = {7}, .uvd_px = *kRig.project(T_cam_body * p_body), .sigma_px = test::kObservationSigma_px, .flow = {}};
  const BodyPoint point = toBody(seen, T_cam_body, kRig);
  EXPECT_EQ(point.point, seen.point);
  EXPECT_THAT(point.p_body, IsNear(p_body, 1e-9));
  EXPECT_THAT(point.covariance,
              IsNear(upright.transpose() * test::triangulationCovariance(seen.uvd_px) * upright, 1e-12));
  EXPECT_GT(point.covariance(0, 0), 10 * point.covariance(1, 1));  // seen from behind: depth is worst
}

}  // namespace
}  // namespace motorcade
