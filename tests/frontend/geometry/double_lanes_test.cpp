#include "frontend/geometry/double_lanes.hpp"

#include <array>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/frontend/geometry/lane.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::lane;

TEST(DoubleLanes, SymmetricMatricesHaveTheirInverse) {
  test::Noise noise(2);
  SymmetricDoubles3x3 lanes{};
  std::array<Eigen::Matrix3d, kDoubleLanes> matrices;
  for (std::size_t i = 0; i < kDoubleLanes; ++i) {
    Eigen::Matrix3d A;
    for (int k = 0; k < 9; ++k) A(k / 3, k % 3) = noise.uniform(-1, 1);
    const Eigen::Matrix3d m = matrices[i] = A * A.transpose() + Eigen::Matrix3d::Identity();
    lanes.xx[i] = m(0, 0), lanes.xy[i] = m(0, 1), lanes.xz[i] = m(0, 2), lanes.yy[i] = m(1, 1), lanes.yz[i] = m(1, 2),
    lanes.zz[i] = m(2, 2);
  }
  const SymmetricDoubles3x3 inverted = inverse(lanes);
  for (std::size_t i = 0; i < kDoubleLanes; ++i) {
    const Eigen::Vector3d ones(1, 1, 1), row = lane(inverted * allDoubles(ones), i);
    EXPECT_THAT(row, test::IsNear(Eigen::Vector3d(matrices[i].inverse() * ones), 1e-12));
  }
}

}  // namespace
}  // namespace motorcade
