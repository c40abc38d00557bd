#include "backend/elimination/row_update.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "core/instruction_set.hpp"
#include "tests/backend/random_panels.hpp"
#include "tests/backend/unpacked.hpp"

namespace motorcade {
namespace {

using Eigen::MatrixXd;
using test::kTol;
using test::PaddedMatrix;
using test::randomMatrix;

/// W^T of some rows, zero above `first`, with the leading dimension of a panel.
MatrixXd rowsFrom(int first, Eigen::Index rows, int count, std::mt19937& random) {
  MatrixXd W = randomMatrix(rows, count, random);
  W.topRows(first).setZero();
  return W;
}

TEST(RowUpdate, AFactorWithMoreRowsIsThatOfTheSum) {
  test::forManySizes([](const test::Elimination& elimination, std::mt19937& random) {
    for (const int count : {1, 3, 6, 7, 13}) {
      const int first = elimination.columns / 3;
      const MatrixXd L = elimination.factor();
      PaddedMatrix panel(L), w(rowsFrom(first, L.rows(), count, random));
      const MatrixXd W = w.view();
      MatrixXd expected = L * L.transpose() + W * W.transpose();
      addRows(panel.panel(), first, w.data(), count);
      EXPECT_TRUE(panel.intactAround() && w.intactAround());
      const auto below = L.rows() - elimination.columns;
      // What W says about the rows below goes on: it is no part of the panel.
      const MatrixXd factor = panel.lower(), rest = w.view().bottomRows(below);
      MatrixXd sum = factor * factor.transpose();
      sum.bottomRightCorner(below, below) += rest * rest.transpose();
      ASSERT_LT((sum - expected).cwiseAbs().maxCoeff(), 10 * kTol) << L.rows() << " x " << elimination.columns;
      EXPECT_EQ(panel.lower().leftCols(first), L.leftCols(first));
    }
  });
}

/// A variable that joins has no rows yet: it gets what is left over.
TEST(RowUpdate, ColumnsOfZerosTakeWhatIsLeftOver) {
  std::mt19937 random(3);
  MatrixXd L = MatrixXd::Zero(21, 12);
  const test::Elimination elimination(21, 6, random);
  L.leftCols(6) = elimination.factor();
  PaddedMatrix panel(L), w(rowsFrom(0, 21, 6, random));
  const MatrixXd W = w.view(), expected = (L * L.transpose() + W * W.transpose()).leftCols(12);
  addRows(panel.panel(), 0, w.data(), 6);
  EXPECT_LT(((panel.lower() * panel.lower().transpose()).leftCols(12) - expected).cwiseAbs().maxCoeff(), 10 * kTol);
}

TEST(RowUpdate, APackedMatrixGrowsByTheProduct) {
  std::mt19937 random(4);
  for (const int count : {1, 3, 6, 8}) {
    for (const int before : {0, 1, 5, 30}) {
      const int size = before + count, ld = size + 1;
      const MatrixXd U = randomMatrix(before, before, random), W = randomMatrix(ld, count, random);
      std::vector<double> packed, grown(PackedTriangle::length(size));
      for (int j = 0; j < before; ++j)
        for (int i = j; i < before; ++i) packed.push_back(U(i, j));
      std::ranges::copy(packed, grown.begin());
      growByProduct(grown.data(), size, grown.data(), W.data(), ld, count);
      const MatrixXd product = W * W.transpose();
      const PackedTriangle result{grown.data(), size};
      for (int j = 0; j < size; ++j)
        for (int i = j; i < size; ++i)
          ASSERT_NEAR(result.column(j)[i], product(i, j) + (j < count ? 0 : U(i - count, j - count)), kTol);
    }
  }
}

#if HWY_ARCH_X86
std::vector<MatrixXd> updatedBy(const char* instructions, int columns, int below) {
  setenv("MOTORCADE_INSTRUCTIONS", instructions, 1);
  chooseInstructions();
  std::mt19937 random(5);
  PaddedMatrix panel(test::Elimination(columns + below, columns, random).factor()),
      w(rowsFrom(0, columns + below, 6, random));
  MatrixXd grown = MatrixXd::Zero(1, static_cast<Eigen::Index>(PackedTriangle::length(columns)));
  const std::vector<double> former(PackedTriangle::length(columns), 0.5);
  growByProduct(grown.data(), columns, former.data(), w.data(), w.ld(), std::min(6, columns));
  addRows(panel.panel(), 0, w.data(), 6);
  unsetenv("MOTORCADE_INSTRUCTIONS");
  chooseInstructions();
  return {panel.lower(), grown};
}

TEST(RowUpdate, EveryInstructionSetGivesTheSameBits) {
  for (const int columns : {1, 3, 6, 18, 50})
    for (const int below : {1, 2, 7, 33}) {
      const auto least = updatedBy("SSE2", columns, below);
      for (const char* const better : {"SSE4", "AVX2", "AVX512"})
        ASSERT_EQ(updatedBy(better, columns, below), least) << better << ": " << columns << " and " << below;
    }
}
#endif

}  // namespace
}  // namespace motorcade
