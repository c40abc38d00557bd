#include "backend/solver/elimination_budget.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(EliminationBudget, HasNoLimitByDefault) {
  EliminationBudget budget({});
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), std::numeric_limits<std::int64_t>::max());
  EXPECT_FALSE(budget.timeIsOver());
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

TEST(EliminationBudget, HalfOfALimitOfTimeIsForEliminationsAtTheirPace) {
  EliminationBudget budget({.scalars = 1000, .ms = 4});
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 1000) << "the pace is not known yet";
  budget.notePace(0, 5);  // nothing eliminated: no pace
  budget.notePace(300, 3);
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 200);
  for (int i = 0; i < 200; ++i) budget.notePace(2000, 1);
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 1000) << "the smaller limit counts";
}

TEST(EliminationBudget, ASlowEliminationCountsAtOnceAndAFastOneLittleByLittle) {
  EliminationBudget budget({.ms = 4});
  budget.notePace(2000, 1);
  budget.notePace(1000, 10);
  budget.beginUpdate();
  EXPECT_EQ(budget.left(), 200);
  budget.notePace(10, 10);  // so few scalars tell little
  budget.beginUpdate();
  EXPECT_NEAR(static_cast<double>(budget.left()), 180, 1);
  budget.notePace(1000, 1);
  budget.beginUpdate();
  EXPECT_NEAR(static_cast<double>(budget.left()), 362, 2);
}

TEST(EliminationBudget, TimeIsOverOnlyWhereItIsLimited) {
  EliminationBudget limited({.ms = 1e-6}), long_enough({.ms = 1e9}), scalars({.scalars = 1});
  for (EliminationBudget* budget : {&limited, &long_enough, &scalars}) {
    budget->notePace(1000, 1);
    budget->beginUpdate();
  }
  EXPECT_TRUE(limited.timeIsOver());
  EXPECT_TRUE(limited.timeForEliminationsIsOver());
  EXPECT_FALSE(long_enough.timeIsOver());
  EXPECT_FALSE(scalars.timeIsOver());
  limited.lift();
  EXPECT_FALSE(limited.timeIsOver());
}

}  // namespace
}  // namespace motorcade
