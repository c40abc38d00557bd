#include "backend/solver/update_budget.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(UpdateBudget, HasNoLimitByDefault) {
  UpdateBudget budget({});
  budget.beginUpdate(100);
  budget.spend(1000);
  EXPECT_EQ(budget.left(), std::numeric_limits<std::int64_t>::max());
  EXPECT_FALSE(budget.limited());
  EXPECT_FALSE(budget.countsTime());
}

TEST(UpdateBudget, WhatIsLeftIsSavedOnlyWhileSomethingWaits) {
  UpdateBudget budget({.scalars = 100});
  budget.beginUpdate(0);
  budget.spend(70);
  budget.saveForNext();
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), 130);
  budget.saveForNext();
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), 150) << "half of a budget is the most that is saved";
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), 100);
}

TEST(UpdateBudget, WhatIsSpentTooMuchTheNextUpdatesLack) {
  UpdateBudget budget({.scalars = 100});
  budget.beginUpdate(0);
  budget.spend(350);
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), -150);
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), -50);
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), 50);
}

TEST(UpdateBudget, KeepsWhatSubstitutionOfEarlierUpdatesWants) {
  UpdateBudget budget({.scalars = 100});
  budget.beginUpdate(30);
  EXPECT_EQ(budget.left(), 70);
  EXPECT_EQ(budget.leftForSubstitution(), 100);
  budget.beginUpdate(1000);
  EXPECT_EQ(budget.left(), 0);
  EXPECT_EQ(budget.leftForSubstitution(), 100);
}

TEST(UpdateBudget, ALimitOfTimeFollowsThePace) {
  UpdateBudget budget({.scalars = 1000, .ms = 2});
  EXPECT_TRUE(budget.countsTime());
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), 1000) << "the pace is not known yet";
  budget.notePace(0, 5);  // nothing done: no pace
  budget.notePace(300, 3);
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), 200);
  for (int i = 0; i < 200; ++i) budget.notePace(2000, 1);
  budget.beginUpdate(0);
  EXPECT_EQ(budget.left(), 1000) << "the smaller limit counts";
  for (int i = 0; i < 200; ++i) budget.notePace(50, 1);
  budget.beginUpdate(0);
  EXPECT_NEAR(static_cast<double>(budget.left()), 100, 1);
}

}  // namespace
}  // namespace motorcade
