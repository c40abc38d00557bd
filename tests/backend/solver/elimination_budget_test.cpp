#include "backend/solver/elimination_budget.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(EliminationBudget, HasNoLimitByDefault) {
  EliminationBudget budget({});
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), std::numeric_limits<std::int64_t>::max());
  EXPECT_FALSE(budget.countsTime());
}

TEST(EliminationBudget, WhatIsLeftIsSavedOnlyWhileAVariableWaits) {
  EliminationBudget budget({.scalars = 100});
  budget.beginUpdate();
  budget.spend(30);
  EXPECT_EQ(budget.left(), 70);
  budget.save(true);
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 170);
  budget.save(false);
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 100);
}

TEST(EliminationBudget, ALimitOfTimeFollowsThePace) {
  EliminationBudget budget({.scalars = 1000, .ms = 2});
  EXPECT_TRUE(budget.countsTime());
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 1000) << "the pace is not known yet";
  budget.notePace(0, 5);  // nothing eliminated: no pace
  budget.notePace(300, 3);
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 200);
  for (int i = 0; i < 200; ++i) budget.notePace(2000, 1);
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 1000) << "the smaller limit counts";
  for (int i = 0; i < 200; ++i) budget.notePace(50, 1);
  budget.beginUpdate();
  EXPECT_NEAR(static_cast<double>(budget.left()), 100, 1);
}

}  // namespace
}  // namespace motorcade
