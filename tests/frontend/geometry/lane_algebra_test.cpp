#include "frontend/geometry/lane_algebra.hpp"

#include <array>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/frontend/geometry/lane.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using namespace HWY_NAMESPACE;
using test::lane;

constexpr int kLanes = static_cast<int>(kDoubleLanes);

TEST(LaneAlgebra, SymmetricMatricesHaveTheirInverse) {
  test::Noise noise(2);
  SymmetricDoubles3x3 lanes{};
  std::array<Eigen::Matrix3d, kDoubleLanes> matrices;
  for (int i = 0; i < kLanes; ++i) {
    Eigen::Matrix3d A;
    for (int k = 0; k < 9; ++k) A(k / 3, k % 3) = noise.uniform(-1, 1);
    const Eigen::Matrix3d m = matrices[i] = A * A.transpose() + Eigen::Matrix3d::Identity();
    lanes.xx.set(i, m(0, 0)), lanes.xy.set(i, m(0, 1)), lanes.xz.set(i, m(0, 2));
    lanes.yy.set(i, m(1, 1)), lanes.yz.set(i, m(1, 2)), lanes.zz.set(i, m(2, 2));
  }
  const SymmetricDoubles3x3 inverted = inverse(lanes);
  for (int i = 0; i < kLanes; ++i) {
    const Eigen::Vector3d ones(1, 1, 1), row = lane(inverted * allDoubles(ones), i);
    EXPECT_THAT(row, test::IsNear(Eigen::Vector3d(matrices[i].inverse() * ones), 1e-12));
  }
}

}  // namespace
}  // namespace motorcade
