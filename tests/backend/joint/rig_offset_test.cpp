#include "backend/joint/rig_offset.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "backend/factors/twist_factors.hpp"

namespace motorcade {
namespace {

constexpr FrameId kFirst{40}, kEarly{44}, kLook{50}, kLate{141};
constexpr double kSame_px = 1e-3;

/// Evidence of landmarks on the offset in a solver, as one measurement.
class RigOffsetTest : public testing::Test {
 protected:
  void landmarksSay(double offset_px, double sigma_px) {
    solver_.addFactor(std::make_unique<VectorPriorFactor>(offset_.variable(), SmallVector::Constant(1, offset_px),
                                                          SmallVector::Constant(1, sigma_px)));
    solver_.update();
    EXPECT_FALSE(offset_.release(kFirst));
  }

  IncrementalSolver solver_{{}};
  RigOffset offset_{solver_, 1.0};
};

TEST_F(RigOffsetTest, IsHeldAtZeroUntilLandmarksClearlySayOtherwise) {
  landmarksSay(1.2, 0.01);
  EXPECT_NEAR(offset_.px(), 0, kSame_px);
  EXPECT_FALSE(offset_.release(kEarly));
  EXPECT_TRUE(offset_.release(kLook));
  solver_.update();
  EXPECT_NEAR(offset_.px(), 1.2, kSame_px);
  EXPECT_NEAR(offset_.sigma_px(), 0.01, kSame_px);
  EXPECT_FALSE(offset_.release(kLook));  // it was released before
}

TEST_F(RigOffsetTest, WhatMayBeDistortionOrIsNotClearReleasesNothing) {
  landmarksSay(0.35, 0.01);
  EXPECT_FALSE(offset_.release(kLook));
  RigOffset other(solver_, 1.0);
  solver_.addFactor(std::make_unique<VectorPriorFactor>(other.variable(), SmallVector::Constant(1, 1.2),
                                                        SmallVector::Constant(1, 0.3)));
  solver_.update();
  EXPECT_FALSE(other.release(kFirst));
  EXPECT_FALSE(other.release(kLook));
}

TEST_F(RigOffsetTest, NothingMovesItAfterTheFirstFramesOfADrive) {
  landmarksSay(1.2, 0.01);
  EXPECT_FALSE(offset_.isDecided(kLook));
  EXPECT_TRUE(offset_.isDecided(kLate));
  EXPECT_FALSE(offset_.release(kLate));
}

TEST_F(RigOffsetTest, TellsUntilItIsDoneThatLandmarksShouldBeEliminatedAnew) {
  landmarksSay(1.2, 0.01);
  EXPECT_FALSE(offset_.hasMoved());
  ASSERT_TRUE(offset_.release(kLook));
  solver_.update();
  EXPECT_TRUE(offset_.hasMoved());
  offset_.holdAsEliminated();
  EXPECT_FALSE(offset_.hasMoved());
}

}  // namespace
}  // namespace motorcade
