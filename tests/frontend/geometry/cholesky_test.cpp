#include "frontend/geometry/cholesky.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using Matrix6 = Cholesky<6>::Matrix;
using Vector6 = Cholesky<6>::Vector;

Matrix6 positiveDefinite(test::Noise& noise) {
  Matrix6 A;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) A(i, j) = noise.uniform(-1, 1);
  return A * A.transpose() + 0.1 * Matrix6::Identity();
}

TEST(Cholesky, SolvesAndInverts) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    test::Noise noise(seed);
    const Matrix6 H = positiveDefinite(noise);
    Vector6 x;
    for (int i = 0; i < 6; ++i) x[i] = noise.uniform(-10, 10);
    const Cholesky<6> factor(H);
    ASSERT_TRUE(factor.positive());
    EXPECT_THAT(factor.solve(H * x), test::IsNear(x, 1e-9));
    EXPECT_THAT(factor.inverse(), test::IsNear(Matrix6(H.inverse()), 1e-9));
  }
}

TEST(Cholesky, ReadsTheLowerTriangleOnly) {
  test::Noise noise(1);
  const Matrix6 H = positiveDefinite(noise);
  Matrix6 lower = H;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(Cholesky<6>(lower).inverse(), test::IsNear(Cholesky<6>(H).inverse(), 0));
}

TEST(Cholesky, TellsWhatIsNotPositiveDefinite) {
  EXPECT_FALSE(Cholesky<6>(Matrix6::Zero()).positive());
  Matrix6 H = Matrix6::Identity();
  H(4, 4) = -1;
  EXPECT_FALSE(Cholesky<6>(H).positive());
  H(4, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Cholesky<6>(H).positive());
  H(4, 4) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(Cholesky<6>(H).positive());
}

}  // namespace
}  // namespace motorcade
