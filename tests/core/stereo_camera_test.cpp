#include "core/stereo_camera.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::numericJacobian;

const StereoCamera kCamera{721.5, 718.0, 609.6, 172.9, 0.5372, 1242, 375};
const Eigen::Vector3d kPoint_cam{-3.2, 1.1, 17.5};

TEST(StereoCamera, TriangulationInvertsProjection) {
  EXPECT_THAT(kCamera.triangulate(*kCamera.project(kPoint_cam)), IsNear(kPoint_cam, 1e-10));
}

TEST(StereoCamera, PointsBehindTheCameraDoNotProject) { EXPECT_FALSE(kCamera.project({0.5, 0.2, -4.0})); }

TEST(StereoCamera, JacobiansMatchFiniteDifferences) {
  const auto project = [](const Eigen::Vector3d& p) { return *kCamera.project(p); };
  EXPECT_THAT(kCamera.projectionJacobian(kPoint_cam), IsNear(numericJacobian(project, kPoint_cam), 1e-6));
  const Eigen::Vector3d uvd_px = project(kPoint_cam);
  const auto triangulate = [](const Eigen::Vector3d& z) { return kCamera.triangulate(z); };
  EXPECT_THAT(kCamera.triangulationJacobian(uvd_px), IsNear(numericJacobian(triangulate, uvd_px), 1e-6));
}

}  // namespace
}  // namespace motorcade
