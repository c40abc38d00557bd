#include "backend/solver/elimination_budget.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr auto kAll = std::numeric_limits<std::int64_t>::max();

TEST(EliminationBudget, HasNoLimitByDefault) {
  EliminationBudget budget({});
  budget.beginUpdate();
  EXPECT_TRUE(budget.affords({kAll, 1e300}));
  EXPECT_TRUE(budget.affordsSubstitution(kAll, 1e300));
  EXPECT_FALSE(budget.isOver());
  EXPECT_FALSE(budget.limited());
}

TEST(EliminationBudget, WhatIsLeftIsSavedOnlyWhileAVariableWaits) {
  EliminationBudget budget({.scalars = 100});
  budget.beginUpdate();
  budget.spend({.scalars = 30});
  EXPECT_EQ(budget.left().scalars, 70);
  budget.save(true);
  budget.beginUpdate();
  EXPECT_EQ(budget.left().scalars, 170);
  budget.save(false);
  budget.beginUpdate();
  EXPECT_EQ(budget.left().scalars, 100);
}

TEST(EliminationBudget, HalfOfTheFlopsAreForEliminationsAndAFifthMoreIfSaved) {
  EliminationBudget budget({.scalars = 1000, .flops = 1e6});
  budget.beginUpdate();
  EXPECT_TRUE(budget.affords({1000, 5e5}));
  EXPECT_FALSE(budget.affords({1000, 5.1e5}));
  EXPECT_FALSE(budget.affords({1001, 5e5})) << "the smaller limit counts";
  budget.save(true);
  budget.beginUpdate();
  EXPECT_TRUE(budget.affords({1000, 7e5}));
  EXPECT_FALSE(budget.affords({1000, 7.1e5}));
}

TEST(EliminationBudget, EndsByTheWorkCounted) {
  EliminationBudget budget({.flops = 1e6});
  budget.beginUpdate();
  budget.spend({.flops = 5.1e5});
  EXPECT_TRUE(budget.isOverForEliminations());
  EXPECT_FALSE(budget.isOverForSubstitution());
  EXPECT_TRUE(budget.affordsSubstitution(kAll, 4.8e5));
  EXPECT_FALSE(budget.affordsSubstitution(kAll, 5e5));
  budget.count(3e5);
  EXPECT_TRUE(budget.isOverForSubstitution());
  EXPECT_FALSE(budget.isOver());
  budget.count(2e5);
  EXPECT_TRUE(budget.isOver());
  budget.lift();
  EXPECT_FALSE(budget.isOver());
}

TEST(EliminationBudget, WhatLagsLeavesLessForEliminations) {
  EliminationBudget budget({.flops = 1e6});
  budget.beginUpdate(true);
  EXPECT_EQ(budget.left().flops, 1e5) << "estimates lag";
  budget.count(7e5);
  budget.endUpdate();
  budget.beginUpdate();
  EXPECT_EQ(budget.left().flops, 5e5);
  budget.count(9e5);
  budget.endUpdate();
  budget.beginUpdate();
  EXPECT_EQ(budget.left().flops, 1e5) << "substitution was cut short";
}

TEST(EliminationBudget, PlannedEliminationsCountAsWhatTheyTake) {
  EliminationBudget budget({.flops = 1e6});
  budget.beginUpdate();
  budget.plan({.flops = 3e5});
  EXPECT_EQ(budget.doneFlops(), 3e5);
  budget.finishPlanned(4e5);
  EXPECT_EQ(budget.doneFlops(), 4e5);
  budget.finishPlanned(1e5);  // of a further step, without a plan
  EXPECT_EQ(budget.doneFlops(), 5e5);
}

/// Flops that a budget of 4 ms gives for eliminations.
double flopsFor4ms(EliminationBudget& budget) {
  budget.beginUpdate();
  return budget.left().flops;
}

TEST(EliminationBudget, ALimitOfTimeIsOneOfFlopsAtThePaceOfTheUpdates) {
  EliminationBudget budget({.ms = 4});
  EXPECT_EQ(flopsFor4ms(budget), std::numeric_limits<double>::infinity()) << "the pace is not known yet";
  budget.notePace(3e6, 3);
  EXPECT_NEAR(flopsFor4ms(budget), 2e6, 1);
  budget.notePace(0.2e6, 1);  // a small update tells little
  EXPECT_NEAR(flopsFor4ms(budget), 1.6e6, 1);
  for (int i = 0; i < 200; ++i) budget.notePace(2e6, 4);
  EXPECT_NEAR(flopsFor4ms(budget), 1e6, 1e3) << "the pace of late";
}

TEST(EliminationBudget, TimeIsOverOnlyWhereItIsLimited) {
  EliminationBudget limited({.ms = 1e-6}), long_enough({.ms = 1e9}), scalars({.scalars = 1});
  for (EliminationBudget* budget : {&limited, &long_enough, &scalars}) {
    budget->notePace(1000, 1);
    budget->beginUpdate();
  }
  EXPECT_TRUE(limited.isOver());
  EXPECT_TRUE(limited.isOverForEliminations());
  EXPECT_FALSE(long_enough.isOver());
  EXPECT_FALSE(scalars.isOver());
  limited.lift();
  EXPECT_FALSE(limited.isOver());
}

}  // namespace
}  // namespace motorcade
