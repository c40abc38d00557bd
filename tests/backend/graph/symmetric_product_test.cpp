#include "backend/graph/symmetric_product.hpp"

#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(SymmetricProduct, EqualsTheProductWithTheWholeMatrix) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int n = 1; n <= 40; ++n) {
    std::vector<double> lower;
    Eigen::MatrixXd whole(n, n);
    for (int j = 0; j < n; ++j)
      for (int i = j; i < n; ++i) lower.push_back(whole(i, j) = whole(j, i) = uniform(random));
    Eigen::VectorXd x(n), y(n);
    for (int i = 0; i < n; ++i) x[i] = uniform(random), y[i] = uniform(random);
    const Eigen::VectorXd expected = y + whole * x;
    addSymmetricProduct({lower.data(), n}, x.data(), y.data());
    EXPECT_LT((y - expected).cwiseAbs().maxCoeff(), 1e-13) << n;
  }
}

}  // namespace
}  // namespace motorcade
