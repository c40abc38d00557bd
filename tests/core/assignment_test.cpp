#include "core/assignment.hpp"

#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr double kForbidden = 10;

double totalCost(const Eigen::MatrixXd& cost, const std::vector<int>& columns) {
  double total = 0;
  for (std::size_t row = 0; row < columns.size(); ++row)
    total += columns[row] < 0 ? kForbidden : cost(row, columns[row]);
  return total;
}

/// The least cost over all ways, by trying them.
double bruteForce(const Eigen::MatrixXd& cost, int row, std::set<int>& used) {
  if (row == cost.rows()) return 0;
  double best = kForbidden + bruteForce(cost, row + 1, used);
  for (int column = 0; column < cost.cols(); ++column) {
    if (!(cost(row, column) < kForbidden) || !used.insert(column).second) continue;
    best = std::min(best, cost(row, column) + bruteForce(cost, row + 1, used));
    used.erase(column);
  }
  return best;
}

TEST(AssignMinCost, EqualsBruteForceOnRandomMatrices) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> size(0, 6);
  std::uniform_real_distribution<double> value(-3, 14);  // about a quarter is forbidden
  for (int trial = 0; trial < 400; ++trial) {
    Eigen::MatrixXd cost(size(random), size(random));
    for (auto& element : cost.reshaped()) element = value(random);
    const auto columns = assignMinCost(cost, kForbidden);
    ASSERT_EQ(columns.size(), static_cast<std::size_t>(cost.rows()));
    std::set<int> used;
    for (std::size_t row = 0; row < columns.size(); ++row) {
      if (columns[row] < 0) continue;
      EXPECT_TRUE(used.insert(columns[row]).second) << "a column was given twice";
      EXPECT_LT(cost(row, columns[row]), kForbidden);
    }
    std::set<int> none;
    EXPECT_NEAR(totalCost(cost, columns), bruteForce(cost, 0, none), 1e-9);
  }
}

TEST(AssignMinCost, TakesNoPairWhoseCostIsNotANumber) {
  Eigen::MatrixXd cost(2, 2);
  cost << std::numeric_limits<double>::quiet_NaN(), 1, 2, std::numeric_limits<double>::infinity();
  EXPECT_EQ(assignMinCost(cost, kForbidden), (std::vector<int>{1, 0}));
}

TEST(AssignMinCost, GivesTheGlobalOptimumWhereTheNearestPairMisleads) {
  Eigen::MatrixXd cost(2, 2);
  cost << 1, 2, 2, 9;
  EXPECT_EQ(assignMinCost(cost, kForbidden), (std::vector<int>{1, 0}));
}

}  // namespace
}  // namespace motorcade
