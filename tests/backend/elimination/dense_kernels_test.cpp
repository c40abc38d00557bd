#include "backend/elimination/dense_kernels.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <random>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kTol = 1e-11;  // rounding of some hundred operations on numbers of size 1, with a condition below 1e3

MatrixXd randomMatrix(Eigen::Index rows, Eigen::Index cols, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// Positive definite, with eigenvalues from 1 to about 5.
MatrixXd randomInformation(Eigen::Index size, std::mt19937& random) {
  const MatrixXd J = randomMatrix(size, size, random);
  return MatrixXd::Identity(size, size) + J.transpose() * J / static_cast<double>(size);
}

/// A matrix as the kernels take it: padded with junk, not aligned, and with canaries all around it.
class PaddedMatrix {
 public:
  explicit PaddedMatrix(const MatrixXd& matrix, double padding = 1e3)
      : rows_(matrix.rows()), cols_(matrix.cols()), ld_((rows_ + 3) / 4 * 4) {
    buffer_.assign(static_cast<std::size_t>(kGuard + ld_ * cols_ + kGuard), kCanary);
    std::fill_n(data(), ld_ * cols_, padding);
    view() = matrix;
  }
  double* data() { return buffer_.data() + kGuard; }
  int ld() const { return static_cast<int>(ld_); }
  Eigen::Map<MatrixXd, 0, Eigen::OuterStride<>> view() { return {data(), rows_, cols_, Eigen::OuterStride<>(ld_)}; }
  MatrixXd lower() { return view().triangularView<Eigen::Lower>(); }
  bool intactAround() const {
    const auto isCanary = [](double value) { return value == kCanary; };
    return std::all_of(buffer_.begin(), buffer_.begin() + kGuard, isCanary) &&
           std::all_of(buffer_.end() - kGuard, buffer_.end(), isCanary);
  }

 private:
  static constexpr std::ptrdiff_t kGuard = 17;  // odd: an address that is not a multiple of 32 bytes
  static constexpr double kCanary = 4.25e77;
  Eigen::Index rows_, cols_, ld_;
  std::vector<double> buffer_;
};

/// [H; g^T] with its factor, for a panel that eliminates the first `columns` of them.
struct Elimination {
  MatrixXd whole;  // [H g; g^T c]
  int columns;

  Elimination(int rows, int eliminated, std::mt19937& random)
      : whole(randomInformation(rows, random)), columns(eliminated) {}
  int rows() const { return static_cast<int>(whole.rows()); }
  MatrixXd panel() const { return whole.leftCols(columns); }
  MatrixXd factor() const { return MatrixXd(whole.llt().matrixL()).leftCols(columns); }
};

template <class F>
void forManySizes(const F& check) {
  std::mt19937 random(7);
  for (int columns = 1; columns <= 40; ++columns)
    for (const int below : {1, 2, 3, 4, 5, 6, 7, 12, 13, 16, 19, 33, 50})
      check(Elimination(columns + below, columns, random), random);
}

TEST(DenseKernels, PanelFactorEqualsThatOfTheWholeMatrix) {
  forManySizes([](const Elimination& elimination, std::mt19937&) {
    PaddedMatrix panel(elimination.panel());
    std::vector<int> singular;
    const double ratio = factorizePanel(panel.data(), panel.ld(), elimination.rows(), elimination.columns, singular);
    EXPECT_THAT(singular, IsEmpty());
    EXPECT_TRUE(panel.intactAround());
    const MatrixXd L = elimination.factor();
    ASSERT_LT((panel.lower() - L).cwiseAbs().maxCoeff(), kTol) << elimination.rows() << " x " << elimination.columns;
    const VectorXd ratios = L.diagonal().cwiseAbs2().cwiseQuotient(elimination.panel().diagonal());
    EXPECT_NEAR(ratio, ratios.minCoeff(), kTol);
  });
}

TEST(DenseKernels, OuterProductOfAPanelLeavesTheSchurComplement) {
  forManySizes([](const Elimination& elimination, std::mt19937&) {
    const int columns = elimination.columns, rest = elimination.rows() - columns;
    PaddedMatrix panel(elimination.factor());
    PaddedMatrix remainder(elimination.whole.bottomRightCorner(rest, rest));
    subtractOuterProduct(remainder.data(), remainder.ld(), panel.data() + columns, panel.ld(), rest, columns);
    const MatrixXd S = panel.view().bottomRows(rest);
    const MatrixXd expected = elimination.whole.bottomRightCorner(rest, rest) - S * S.transpose();
    ASSERT_LT((remainder.lower() - MatrixXd(expected.triangularView<Eigen::Lower>())).cwiseAbs().maxCoeff(), kTol);
    EXPECT_TRUE(remainder.intactAround());
  });
}

TEST(DenseKernels, OuterProductTakesMoreColumnsThanItCaches) {
  std::mt19937 random(2);
  for (const int k : {47, 48, 49, 96, 97, 150}) {
    const MatrixXd A = randomMatrix(29, k, random), C = randomInformation(29, random);
    PaddedMatrix left(A), remainder(C);
    subtractOuterProduct(remainder.data(), remainder.ld(), left.data(), left.ld(), 29, k);
    const MatrixXd expected = (C - A * A.transpose()).triangularView<Eigen::Lower>();
    EXPECT_LT((remainder.lower() - expected).cwiseAbs().maxCoeff(), kTol);
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
  const Elimination elimination(30, 11, random);
  PaddedMatrix one(elimination.panel(), -7e5), other(elimination.panel(), 0);
  one.view().topRows(11).triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  std::vector<int> singular;
  factorizePanel(one.data(), one.ld(), 30, 11, singular);
  factorizePanel(other.data(), other.ld(), 30, 11, singular);
  EXPECT_EQ(one.lower(), other.lower());
}

TEST(DenseKernels, SingularScalarsAreReplacedAndTheOthersUnchanged) {
  std::mt19937 random(11);
  for (const int bad : {0, 1, 3, 4, 6, 10}) {
    for (const double diagonal :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      const Elimination elimination(29, 11, random);
      MatrixXd unconstrained = elimination.whole;
      unconstrained.row(bad).setZero();
      unconstrained.col(bad).setZero();
      unconstrained(bad, bad) = 1;
      const MatrixXd expected = MatrixXd(unconstrained.llt().matrixL()).leftCols(11);
      unconstrained(bad, bad) = diagonal;
      PaddedMatrix panel(unconstrained.leftCols(11));
      std::vector<int> singular;
      const double ratio = factorizePanel(panel.data(), panel.ld(), 29, 11, singular);
      EXPECT_THAT(singular, ElementsAre(bad));
      EXPECT_LT((panel.lower() - expected).cwiseAbs().maxCoeff(), kTol);
      EXPECT_GT(ratio, 0.1);
    }
  }
}

TEST(DenseKernels, NotANumberInAColumnStaysInIt) {
  std::mt19937 random(13);
  const Elimination elimination(29, 11, random);
  PaddedMatrix panel(elimination.panel());
  panel.view()(20, 5) = panel.view()(5, 5) = std::numeric_limits<double>::quiet_NaN();
  std::vector<int> singular;
  factorizePanel(panel.data(), panel.ld(), 29, 11, singular);
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
    factorizePanel(panel.data(), panel.ld(), columns + 6, columns, singular);
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

TEST(DenseKernels, BackSubstitutionSolvesForTheFrontalScalars) {
  forManySizes([](const Elimination& elimination, std::mt19937& random) {
    const int columns = elimination.columns, separator = elimination.rows() - 1 - columns;
    const MatrixXd L = elimination.factor();
    PaddedMatrix panel(L);
    panel.view().topRows(columns).triangularView<Eigen::StrictlyUpper>().setConstant(1e3);
    const VectorXd x_separator = randomMatrix(separator, 1, random);
    const std::vector<double> exact(x_separator.data(), x_separator.data() + separator);
    std::vector<double> x_frontal(static_cast<std::size_t>(columns));
    backSubstitute(panel.data(), panel.ld(), elimination.rows(), columns, exact.data(), x_frontal.data());
    const VectorXd right = -L.bottomRows(1).transpose() - L.middleRows(columns, separator).transpose() * x_separator;
    const VectorXd expected = L.topRows(columns).triangularView<Eigen::Lower>().transpose().solve(right);
    ASSERT_LT((Eigen::Map<VectorXd>(x_frontal.data(), columns) - expected).cwiseAbs().maxCoeff(), kTol);
  });
}

TEST(DenseKernels, ForwardSubstitutionEqualsTheFactorOfTheNewRightHandSide) {
  forManySizes([](const Elimination& elimination, std::mt19937&) {
    const int columns = elimination.columns, rows = elimination.rows(), separator = rows - 1 - columns;
    const VectorXd right = elimination.whole.row(rows - 1).head(rows - 1);
    const MatrixXd L = elimination.factor();
    PaddedMatrix panel(L);
    panel.view().topRows(columns).triangularView<Eigen::StrictlyUpper>().setConstant(1e3);
    panel.view().row(rows - 1).setConstant(1e3);
    std::vector<double> g(right.data(), right.data() + rows - 1);
    double c = 2;
    forwardSubstitute(panel.data(), panel.ld(), rows, columns, {}, g.data(), c);
    const VectorXd d = L.bottomRows(1).transpose();
    ASSERT_LT((panel.lower() - L).cwiseAbs().maxCoeff(), kTol);
    VectorXd expected(rows - 1);
    expected << d, right.tail(separator) - L.middleRows(columns, separator) * d;
    ASSERT_LT((Eigen::Map<VectorXd>(g.data(), rows - 1) - expected).cwiseAbs().maxCoeff(), kTol);
    EXPECT_NEAR(c, 2 - d.squaredNorm(), kTol);
    EXPECT_TRUE(panel.intactAround());
  });
}

TEST(DenseKernels, ForwardSubstitutionLeavesSingularScalarsAtZero) {
  std::mt19937 random(23);
  const Elimination elimination(20, 9, random);
  PaddedMatrix panel(elimination.panel());
  panel.view()(6, 6) = 0;
  std::vector<int> singular;
  factorizePanel(panel.data(), panel.ld(), 20, 9, singular);
  ASSERT_THAT(singular, ElementsAre(6));
  std::vector<double> g(19, 1.0), x_frontal(9);
  double c = 0;
  forwardSubstitute(panel.data(), panel.ld(), 20, 9, singular, g.data(), c);
  EXPECT_EQ(panel.view()(19, 6), 0);
  EXPECT_NEAR(c, -panel.view().row(19).squaredNorm(), kTol);
  backSubstitute(panel.data(), panel.ld(), 20, 9, g.data() + 9, x_frontal.data());
  EXPECT_EQ(x_frontal[6], 0);
}

}  // namespace
}  // namespace motorcade
