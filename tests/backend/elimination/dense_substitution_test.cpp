#include "backend/elimination/dense_substitution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/backend/random_panels.hpp"

namespace motorcade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::forManySizes;
using test::kTol;
using test::PaddedMatrix;
using test::randomMatrix;
using testing::ElementsAre;

TEST(DenseSubstitution, BackSubstitutionSolvesForTheFrontalScalars) {
  forManySizes([](const test::Elimination& elimination, std::mt19937& random) {
    const int columns = elimination.columns, separator = elimination.rows() - 1 - columns;
    const MatrixXd L = elimination.factor();
    PaddedMatrix panel(L);
    panel.view().topRows(columns).triangularView<Eigen::StrictlyUpper>().setConstant(1e3);
    const VectorXd x_separator = randomMatrix(separator, 1, random);
    const std::vector<double> exact(x_separator.data(), x_separator.data() + separator);
    std::vector<double> x_frontal(columns);
    backSubstitute(panel.panel(), exact.data(), x_frontal.data());
    const VectorXd right = -L.bottomRows(1).transpose() - L.middleRows(columns, separator).transpose() * x_separator;
    const VectorXd expected = L.topRows(columns).triangularView<Eigen::Lower>().transpose().solve(right);
    ASSERT_LT((Eigen::Map<VectorXd>(x_frontal.data(), columns) - expected).cwiseAbs().maxCoeff(), kTol);
  });
}

TEST(DenseSubstitution, ForwardSubstitutionEqualsTheFactorOfTheNewRightHandSide) {
  forManySizes([](const test::Elimination& elimination, std::mt19937&) {
    const int columns = elimination.columns, rows = elimination.rows(), separator = rows - 1 - columns;
    const VectorXd right = elimination.whole.row(rows - 1).head(rows - 1);
    const MatrixXd L = elimination.factor();
    PaddedMatrix panel(L);
    panel.view().topRows(columns).triangularView<Eigen::StrictlyUpper>().setConstant(1e3);
    panel.view().row(rows - 1).setConstant(1e3);
    std::vector<double> g(right.data(), right.data() + rows - 1);
    forwardSubstitute(panel.panel(), {}, g.data());
    const VectorXd d = L.bottomRows(1).transpose();
    ASSERT_LT((panel.lower() - L).cwiseAbs().maxCoeff(), kTol);
    VectorXd expected(rows - 1);
    expected << d, right.tail(separator) - L.middleRows(columns, separator) * d;
    ASSERT_LT((Eigen::Map<VectorXd>(g.data(), rows - 1) - expected).cwiseAbs().maxCoeff(), kTol);
    EXPECT_TRUE(panel.intactAround());
  });
}

TEST(DenseSubstitution, ForwardSubstitutionOfSeveralRightHandSidesEqualsThatOfEach) {
  forManySizes([](const test::Elimination& elimination, std::mt19937& random) {
    const int columns = elimination.columns, rows = elimination.rows() - 1, separator = rows - columns;
    const MatrixXd L = elimination.factor();
    PaddedMatrix panel(L);
    panel.view().topRows(columns).triangularView<Eigen::StrictlyUpper>().setConstant(1e3);
    for (const int stride : {4, 12, 16, 20}) {
      const MatrixXd right = randomMatrix(rows, stride, random);
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> y = right;
      forwardSubstitute(panel.panel(), y.data(), stride);
      const MatrixXd upper = L.topRows(columns).triangularView<Eigen::Lower>().solve(right.topRows(columns));
      ASSERT_LT((y.topRows(columns) - upper).cwiseAbs().maxCoeff(), kTol);
      const MatrixXd lower = right.bottomRows(separator) - L.middleRows(columns, separator) * upper;
      if (separator == 0) continue;
      ASSERT_LT((y.bottomRows(separator) - lower).cwiseAbs().maxCoeff(), kTol);
    }
  });
}

TEST(DenseSubstitution, ForwardSubstitutionLeavesSingularScalarsAtZero) {
  std::mt19937 random(23);
  const test::Elimination elimination(20, 9, random);
  PaddedMatrix panel(elimination.panel());
  panel.view()(6, 6) = 0;
  std::vector<int> singular;
  factorizePanel(panel.panel(), singular);
  ASSERT_THAT(singular, ElementsAre(6));
  std::vector<double> g(19, 1.0), x_frontal(9);
  forwardSubstitute(panel.panel(), singular, g.data());
  EXPECT_EQ(panel.view()(19, 6), 0);
  backSubstitute(panel.panel(), g.data() + 9, x_frontal.data());
  EXPECT_EQ(x_frontal[6], 0);
}

}  // namespace
}  // namespace motorcade
