#include "backend/elimination/dense_kernels.hpp"

#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/instruction_set.hpp"
#include "tests/backend/random_panels.hpp"

namespace motorcade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::forManySizes;
using test::kTol;
using test::PaddedMatrix;
using test::randomInformation;
using test::randomMatrix;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(DenseKernels, PanelFactorEqualsThatOfTheWholeMatrix) {
  forManySizes([](const test::Elimination& elimination, std::mt19937&) {
    PaddedMatrix panel(elimination.panel());
    std::vector<int> singular;
    const double ratio = factorizePanel(panel.panel(), singular);
    EXPECT_THAT(singular, IsEmpty());
    EXPECT_TRUE(panel.intactAround());
    const MatrixXd L = elimination.factor();
    ASSERT_LT((panel.lower() - L).cwiseAbs().maxCoeff(), kTol) << elimination.rows() << " x " << elimination.columns;
    const VectorXd ratios = L.diagonal().cwiseAbs2().cwiseQuotient(elimination.panel().diagonal());
    EXPECT_NEAR(ratio, ratios.minCoeff(), kTol);
  });
}

TEST(DenseKernels, OuterProductOfAPanelLeavesTheSchurComplement) {
  forManySizes([](const test::Elimination& elimination, std::mt19937&) {
    const int columns = elimination.columns, rest = elimination.rows() - columns;
    PaddedMatrix panel(elimination.factor());
    PaddedMatrix update(elimination.whole.bottomRightCorner(rest, rest));
    subtractOuterProduct(update.data(), update.ld(), panel.data() + columns, panel.ld(), rest, columns);
    const MatrixXd S = panel.view().bottomRows(rest);
    const MatrixXd expected = elimination.whole.bottomRightCorner(rest, rest) - S * S.transpose();
    ASSERT_LT((update.lower() - MatrixXd(expected.triangularView<Eigen::Lower>())).cwiseAbs().maxCoeff(), kTol);
    EXPECT_TRUE(update.intactAround());
  });
}

TEST(DenseKernels, OuterProductTakesMoreColumnsThanItCaches) {
  std::mt19937 random(2);
  for (const int k : {47, 48, 49, 96, 97, 150}) {
    const MatrixXd A = randomMatrix(29, k, random), C = randomInformation(29, random);
    PaddedMatrix left(A), update(C);
    subtractOuterProduct(update.data(), update.ld(), left.data(), left.ld(), 29, k);
    const MatrixXd expected = (C - A * A.transpose()).triangularView<Eigen::Lower>();
    EXPECT_LT((update.lower() - expected).cwiseAbs().maxCoeff(), kTol);
  }
}

TEST(DenseKernels, OuterProductReadsNothingPastItsRows) {
  std::mt19937 random(3);
  for (int n = 1; n <= 40; ++n) {
    const MatrixXd A = randomMatrix(n, 1, random);
    std::vector<double> exact(A.data(), A.data() + n);  // the address sanitizer watches its end
    PaddedMatrix C(MatrixXd::Zero(n, n));
    subtractOuterProduct(C.data(), C.ld(), exact.data(), C.ld(), n, 1);
    EXPECT_LT((C.lower() + MatrixXd((A * A.transpose()).triangularView<Eigen::Lower>())).cwiseAbs().maxCoeff(), kTol);
  }
}

TEST(DenseKernels, PaddingDoesNotMatter) {
  std::mt19937 random(5);
  const test::Elimination elimination(30, 11, random);
  PaddedMatrix one(elimination.panel(), -7e5), other(elimination.panel(), 0);
  one.view().topRows(11).triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  std::vector<int> singular;
  factorizePanel(one.panel(), singular);
  factorizePanel(other.panel(), singular);
  EXPECT_EQ(one.lower(), other.lower());
}

TEST(DenseKernels, SingularScalarsAreReplacedAndTheOthersUnchanged) {
  std::mt19937 random(11);
  for (const int bad : {0, 1, 3, 4, 6, 10}) {
    for (const double diagonal :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      const test::Elimination elimination(29, 11, random);
      MatrixXd unconstrained = elimination.whole;
      unconstrained.row(bad).setZero();
      unconstrained.col(bad).setZero();
      unconstrained(bad, bad) = 1;
      const MatrixXd expected = MatrixXd(unconstrained.llt().matrixL()).leftCols(11);
      unconstrained(bad, bad) = diagonal;
      PaddedMatrix panel(unconstrained.leftCols(11));
      std::vector<int> singular;
      const double ratio = factorizePanel(panel.panel(), singular);
      EXPECT_THAT(singular, ElementsAre(bad));
      EXPECT_LT((panel.lower() - expected).cwiseAbs().maxCoeff(), kTol);
      EXPECT_GT(ratio, 0.1);
    }
  }
}

TEST(DenseKernels, NotANumberInAColumnStaysInIt) {
  std::mt19937 random(13);
  const test::Elimination elimination(29, 11, random);
  PaddedMatrix panel(elimination.panel());
  panel.view()(20, 5) = panel.view()(5, 5) = std::numeric_limits<double>::quiet_NaN();
  std::vector<int> singular;
  factorizePanel(panel.panel(), singular);
  EXPECT_THAT(singular, ElementsAre(5));
  EXPECT_TRUE(panel.lower().allFinite());
}

TEST(DenseKernels, DependentScalarIsSingular) {
  std::mt19937 random(17);
  for (int columns = 2; columns <= 13; ++columns) {
    MatrixXd J = randomMatrix(40, columns + 6, random);
    J.col(columns - 1) = J.leftCols(columns - 1).rowwise().sum();
    PaddedMatrix panel((J.transpose() * J).leftCols(columns));
    std::vector<int> singular;
    factorizePanel(panel.panel(), singular);
    EXPECT_THAT(singular, ElementsAre(columns - 1));
    EXPECT_TRUE(panel.view().col(columns - 1).tail(6).isZero(0));
  }
}

TEST(DenseKernels, JacobianProductAddsTheLowerTriangle) {
  std::mt19937 random(19);
  for (const int rows : {1, 2, 3, 4, 6, 7, 9, 12, 15}) {
    for (int cols = 1; cols <= 32; ++cols) {
      const MatrixXd J = randomMatrix(rows, cols, random), H = randomInformation(cols, random);
      const std::vector<double> exact(J.data(), J.data() + J.size());
      PaddedMatrix sum(H);
      addJacobianProduct(exact.data(), rows, cols, sum.data(), sum.ld());
      const MatrixXd expected = (H + J.transpose() * J).triangularView<Eigen::Lower>();
      ASSERT_LT((sum.lower() - expected).cwiseAbs().maxCoeff(), kTol) << rows << " x " << cols;
      EXPECT_TRUE(sum.intactAround());
    }
  }
}

#if HWY_ARCH_X86
/// A panel's factor and what it leaves on the rest, by kernels for these instructions.
std::vector<MatrixXd> eliminatedBy(const char* instructions, const test::Elimination& elimination) {
  setenv("MOTORCADE_INSTRUCTIONS", instructions, 1);
  chooseInstructions();
  const int columns = elimination.columns, rest = elimination.rows() - columns;
  PaddedMatrix panel(elimination.panel()), update(elimination.whole.bottomRightCorner(rest, rest));
  std::vector<int> singular;
  factorizePanel(panel.panel(), singular);
  subtractOuterProduct(update.data(), update.ld(), panel.data() + columns, panel.ld(), rest, columns);
  EXPECT_TRUE(panel.intactAround() && update.intactAround());
  unsetenv("MOTORCADE_INSTRUCTIONS");
  chooseInstructions();
  return {panel.lower(), update.lower()};
}

TEST(DenseKernels, EveryInstructionSetGivesTheSameBits) {
  std::mt19937 random(23);
  for (const int columns : {1, 3, 6, 18, 50}) {
    for (int below = 1; below <= 60; ++below) {
      const test::Elimination elimination(columns + below, columns, random);
      const auto least = eliminatedBy("SSE2", elimination);
      for (const char* const better : {"SSE4", "AVX2", "AVX512"})
        ASSERT_EQ(eliminatedBy(better, elimination), least) << better << ": " << columns << " and " << below;
    }
  }
}
#endif

}  // namespace
}  // namespace motorcade
