#include "backend/elimination/front_sums.hpp"

#include <gtest/gtest.h>

#include "tests/backend/random_panels.hpp"

namespace motorcade {
namespace {

using Eigen::MatrixXd;
using test::PaddedMatrix;
using test::randomInformation;

constexpr int kFrontals = 8, kSize = 29;  // scalars of the front

/// A front of zeros: a panel, and an update matrix.
struct ZeroFront {
  PaddedMatrix panel{MatrixXd::Zero(kSize, kFrontals), 0},
      update{MatrixXd::Zero(kSize - kFrontals, kSize - kFrontals), 0};

  FrontColumns columns() {
    return {.panel = panel.data(),
            .panel_stride = panel.ld(),
            .panel_columns = kFrontals,
            .update_matrix = update.data(),
            .update_stride = update.ld()};
  }
  MatrixXd lower() {
    MatrixXd whole = MatrixXd::Zero(kSize, kSize);
    whole.leftCols<kFrontals>() = panel.view();
    whole.bottomRightCorner(kSize - kFrontals, kSize - kFrontals) = update.view();
    return whole;
  }
};

/// The lower triangle of the front with the matrix's rows where the spans say.
MatrixXd expectedSum(const MatrixXd& matrix, std::span<const RowSpan> spans) {
  MatrixXd whole = MatrixXd::Zero(kSize, kSize);
  for (const RowSpan& rows : spans)
    for (const RowSpan& columns : spans)
      whole.block(rows.to, columns.to, rows.size, columns.size) =
          matrix.block(rows.from, columns.from, rows.size, columns.size);
  return whole.triangularView<Eigen::Lower>();
}

/// Rows in pieces of all sizes, some of them in another order than in the front, and on both sides of the border.
const std::vector<std::vector<RowSpan>> kPlaces{{{0, 0, 6}, {6, 22, 6}, {12, 28, 1}},
                                                {{0, 14, 3}, {3, 2, 3}, {6, 28, 1}},
                                                {{0, 8, 13}, {13, 3, 5}},
                                                {{0, 27, 2}, {2, 8, 1}, {3, 0, 8}},
                                                {{0, 12, 4}, {4, 0, 7}, {11, 9, 3}, {14, 22, 6}}};

TEST(FrontSums, APackedMatrixIsAddedWhereItsRowsLie) {
  std::mt19937 random(1);
  for (const auto& spans : kPlaces) {
    const int size = spans.back().from + spans.back().size;
    const MatrixXd matrix = randomInformation(size, random).selfadjointView<Eigen::Lower>();
    std::vector<double> packed;
    for (int j = 0; j < size; ++j)
      for (int i = j; i < size; ++i) packed.push_back(matrix(i, j));
    ZeroFront front;
    for (int times = 1; times <= 2; ++times) {
      addToFront(front.columns(), PackedTriangle{packed.data(), size}, spans);
      EXPECT_EQ(front.lower(), times * expectedSum(matrix, spans));
    }
    EXPECT_TRUE(front.panel.intactAround() && front.update.intactAround());
  }
}

TEST(FrontSums, OfAWholeMatrixTheLowerTriangleCounts) {
  std::mt19937 random(2);
  for (const auto& spans : kPlaces) {
    const int size = spans.back().from + spans.back().size;
    const MatrixXd matrix = randomInformation(size, random).selfadjointView<Eigen::Lower>();
    PaddedMatrix lower(matrix.triangularView<Eigen::Lower>());
    ZeroFront front;
    addToFront(front.columns(), lower.data(), lower.ld(), spans);
    EXPECT_EQ(front.lower(), expectedSum(matrix, spans));
  }
}

/// Columns of Jacobians of one to three poses, and of their residual.
const std::vector<std::vector<RowSpan>> kPoses{{{0, 22, 6}, {6, 28, 1}},
                                               {{3, 2, 3}, {0, 25, 3}, {6, 28, 1}},
                                               {{6, 2, 6}, {0, 12, 6}, {12, 28, 1}},
                                               {{3, 0, 6}, {0, 8, 3}, {9, 11, 6}, {15, 28, 1}}};

TEST(FrontSums, TheSquareOfAJacobianIsThatOfThePaddedProduct) {
  std::mt19937 random(3);
  for (const int rows : {3, 6, 12})
    for (const auto& spans : kPoses) {
      const int columns = spans.back().from + 1;
      const MatrixXd jacobian = test::randomMatrix(rows, columns, random);
      PaddedMatrix product(MatrixXd::Zero(columns, columns));
      addJacobianProduct(jacobian.data(), rows, columns, product.data(), product.ld());
      const MatrixXd whole = product.view().selfadjointView<Eigen::Lower>();
      ZeroFront front;
      for (int times = 1; times <= 2; ++times) {
        ASSERT_TRUE(addSquareToFront(front.columns(), jacobian.data(), rows, spans));
        const MatrixXd lower = front.lower().triangularView<Eigen::Lower>();
        EXPECT_EQ(lower, times * expectedSum(whole, spans));
      }
      EXPECT_TRUE(front.panel.intactAround() && front.update.intactAround());
    }
}

TEST(FrontSums, OtherSizesOfJacobiansAreLeftToTheCaller) {
  const MatrixXd jacobian = MatrixXd::Ones(6, 7);
  const std::vector<RowSpan> vector{{0, 2, 4}, {4, 28, 1}}, pose{{0, 2, 6}, {6, 28, 1}};
  ZeroFront front;
  EXPECT_FALSE(addSquareToFront(front.columns(), jacobian.data(), 6, vector));
  EXPECT_FALSE(addSquareToFront(front.columns(), jacobian.data(), 2, pose));
  EXPECT_EQ(front.lower(), MatrixXd::Zero(kSize, kSize));
}

TEST(FrontSums, ALowerTriangleIsClearedWithTheBlocksOnItsDiagonal) {
  for (const int size : {1, 4, 7, 21}) {
    PaddedMatrix matrix(MatrixXd::Ones(size, size));
    clearLowerTriangle(matrix.data(), matrix.ld(), size);
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) EXPECT_EQ(matrix.view()(i, j), i / 4 < j / 4 ? 1 : 0);
    EXPECT_TRUE(matrix.intactAround());
  }
}

TEST(FrontSums, APackedTriangleHasTheColumnsWithoutGaps) {
  std::mt19937 random(4);
  for (const int size : {1, 2, 5, 8, 23}) {
    PaddedMatrix matrix(randomInformation(size, random));
    std::vector<double> packed(PackedTriangle::length(size) + 1, -1.0);
    packLowerTriangle(matrix.data(), matrix.ld(), size, packed.data());
    const PackedTriangle triangle{packed.data(), size};
    for (int j = 0; j < size; ++j)
      for (int i = j; i < size; ++i) EXPECT_EQ(triangle.column(j)[i], matrix.view()(i, j));
    EXPECT_EQ(packed.back(), -1.0);  // nothing past the end is written
  }
}

}  // namespace
}  // namespace motorcade
