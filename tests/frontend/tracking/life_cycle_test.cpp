#include "frontend/tracking/life_cycle.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(LifeCycle, BeginsTentativeWithTheObservationOfItsSpawning) {
  const LifeCycle life;
  EXPECT_EQ(life.phase(), Phase::kTentative);
  EXPECT_EQ(life.observations(), 1);
  EXPECT_EQ(life.missed(), 0);
  EXPECT_FALSE(life.reported());
}

TEST(LifeCycle, AConfirmedObjectIsLostWhileItIsMissed) {
  LifeCycle life;
  life.observe();
  life.confirm();
  EXPECT_EQ(life.phase(), Phase::kConfirmed);
  life.miss();
  life.miss();
  EXPECT_EQ(life.phase(), Phase::kLost);
  EXPECT_EQ(life.missed(), 2);
  life.observe();
  EXPECT_EQ(life.phase(), Phase::kConfirmed);
  EXPECT_EQ(life.missed(), 0);
  EXPECT_EQ(life.observations(), 3);
}

TEST(LifeCycle, ATentativeObjectStaysTentativeWhenItIsMissed) {
  LifeCycle life;
  life.miss();
  EXPECT_EQ(life.phase(), Phase::kTentative);
  EXPECT_EQ(life.missed(), 1);
}

TEST(LifeCycle, WhatEndsKeepsWhetherItWasReported) {
  LifeCycle tentative, lost;
  lost.confirm();
  lost.miss();
  tentative.end();
  lost.end();
  EXPECT_EQ(tentative.phase(), Phase::kEnded);
  EXPECT_EQ(lost.phase(), Phase::kEnded);
  EXPECT_FALSE(tentative.reported());
  EXPECT_TRUE(lost.reported());
}

}  // namespace
}  // namespace motorcade
