#include "backend/elimination/clique_cost.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

Clique cliqueOf(int frontals, int size) {
  Clique clique;
  clique.frontal_size = frontals;
  clique.size = size;
  return clique;
}

TEST(CliqueCost, OfALargeCliqueIsThatOfTheArithmetic) {
  const auto cost = eliminationCost(cliqueOf(600, 1200));
  EXPECT_EQ(cost.scalars, 600);
  const double operations = 600.0 * 600 * 600 * (1.0 / 3 + 1 + 1);
  EXPECT_GT(cost.flops, operations);
  EXPECT_LT(cost.flops, 1.4 * operations) << "memory traffic";
}

TEST(CliqueCost, LiftingThroughALargeCliqueCostsAFractionOfEliminatingIt) {
  const Clique large = cliqueOf(600, 1200), small = cliqueOf(18, 72);
  EXPECT_LT(liftCost(large, 6).flops, 0.2 * eliminationCost(large).flops);
  EXPECT_LT(liftCost(small, 6).flops, 2 * eliminationCost(small).flops);
  EXPECT_GT(liftCost(large, 6).flops, liftCost(large, 3).flops);
}

TEST(CliqueCost, SubstitutionCostsLessThanAnElimination) {
  const Clique clique = cliqueOf(18, 72);
  EXPECT_GT(substitutionFlops(clique), 0);
  EXPECT_LT(substitutionFlops(clique), eliminationCost(clique).flops);
}

}  // namespace
}  // namespace motorcade
