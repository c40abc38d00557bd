#include "core/decompositions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/fixed_product.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::Noise;

constexpr double kRounding = 1e-12;  // of some dozen operations on numbers of about one

/// Its eigenvalues are one at least.
Matrix6d covariance(Noise& noise) { return test::randomCovariance<6>(noise, Vector6d::Ones()) + Matrix6d::Identity(); }

TEST(Decompositions, InvertMatricesByThemselvesAndByTheirCholeskyFactors) {
  Noise noise(1);
  for (int i = 0; i < 20; ++i) {
    const Matrix6d C = covariance(noise);
    EXPECT_THAT(inverse(C) * C, IsNear(Matrix6d::Identity(), 1e3 * kRounding));
    EXPECT_THAT(inverse(Eigen::LLT<Matrix6d>(C)), IsNear(inverse(C), 1e3 * kRounding));
  }
}

TEST(Decompositions, HaveEigenvaluesInRisingOrderAndVectorsThatMakeTheMatrix) {
  Noise noise(2);
  for (int i = 0; i < 20; ++i) {
    const Eigen::MatrixXd C = covariance(noise);
    const SymmetricEigen eigen(C);
    EXPECT_THAT(eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose(), IsNear(C, kRounding));
    EXPECT_THAT(eigen.vectors.transpose() * eigen.vectors, IsNear(Matrix6d::Identity(), kRounding));
    for (int k = 1; k < 6; ++k) EXPECT_LE(eigen.values[k - 1], eigen.values[k]);
  }
}

TEST(FixedProduct, PropagatesCovariances) {
  Noise noise(3);
  Eigen::Matrix<double, 3, 6> J;
  for (double& entry : J.reshaped()) entry = noise.gaussian();
  const Matrix6d C = covariance(noise);
  EXPECT_THAT(propagated(J, C), IsNear(J * C * J.transpose(), 1e2 * kRounding));
}

}  // namespace
}  // namespace motorcade
