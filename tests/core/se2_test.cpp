#include "core/se2.hpp"

#include <gtest/gtest.h>

#include "core/se3.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;

const std::array<Eigen::Vector3d, 5> kTwists{
    Eigen::Vector3d{1, -2, 0.7}, {0.3, 0.1, -3.1}, {2, 1, 1e-6}, {-1, 4, 0}, {0.1, 0.2, 5e-4}};

TEST(SE2, IsSE3InThePlane) {
  for (const auto& xi : kTwists) {
    Vector6d in_space = Vector6d::Zero();
    in_space[0] = xi[0], in_space[1] = xi[1], in_space[5] = xi[2];
    const SE2 T = SE2::exp(xi);
    const SE3 reference = SE3::exp(in_space);
    EXPECT_THAT(T.translation(), IsNear(reference.translation().head<2>().eval(), 1e-12));
    EXPECT_THAT(T.rotation(), IsNear(reference.rotation().topLeftCorner<2, 2>().eval(), 1e-12));
    EXPECT_THAT(T.log(), IsNear(xi, 1e-9));
    EXPECT_THAT((T * T.inverse()).log(), IsNear(Eigen::Vector3d::Zero().eval(), 1e-12));
  }
}

TEST(SE2, AdjointMovesATwistThroughAPose) {
  const SE2 T(0.8, {3, -1});
  const Eigen::Vector3d xi(0.2, 0.5, -0.4);
  EXPECT_THAT((T * SE2::exp(xi) * T.inverse()).log(), IsNear((T.adjoint() * xi).eval(), 1e-12));
}

TEST(SE2, WrapsItsAngle) { EXPECT_NEAR((SE2(3, {0, 0}) * SE2(3, {0, 0})).angle_rad(), 6 - 2 * M_PI, 1e-12); }

}  // namespace
}  // namespace motorcade
