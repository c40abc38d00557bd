#include "backend/joint/landmarks_at_rest.hpp"

#include <gtest/gtest.h>

#include "backend/factors/pose_factors.hpp"
#include "backend/joint/rig_offset.hpp"
#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;

/// Cameras that begin half a meter beside where they are, and are linked by landmarks alone.
class Street {
 public:
  explicit Street(int static_points = 150)
      : drive_(3, {.static_points = static_points, .drive = {.frames = 30, .vehicles = {}}}) {}

  void see(int frame) {
    at_rest_.bundles().points().observe({frame}, drive_.measure(frame)->at_rest);
    const SE3 beside = frame == 0 ? SE3{} : SE3(expSO3({0, 0.01, 0}), {0.2, 0.1, 0.5});
    CameraRecord& camera = frames_[{frame}];
    camera.head.frame = {frame};
    camera.x = solver_.addVariable(truth(frame) * beside);
    const double sigma = frame == 0 ? 1e-3 : 10;
    solver_.addFactor(priorFactor(camera.x, truth(frame) * beside, poseSigmas(sigma, sigma, sigma)));
    at_rest_.add(frame, frames_, {});
    EXPECT_TRUE(solver_.update().problems.empty()) << frame;
  }
  double error_m(int frame) const {
    return (truth(frame).inverse() * solver_.pose(frames_.at({frame}).x)).translation().norm();
  }
  LandmarksAtRest& landmarks() { return at_rest_; }
  const LandmarksAtRest::Frames& frames() const { return frames_; }
  std::size_t factorsOfCamera(int frame) const { return solver_.graph().factorsOf(frames_.at({frame}).x).size(); }
  IncrementalSolver& solver() { return solver_; }

 private:
  SE3 truth(int frame) const { return drive_.truth().camera(frame); }

  test::PointDrive drive_;
  JointParams params_;
  IncrementalSolver solver_{{}};
  RigOffset offset_{solver_, 0};
  LandmarksAtRest::Frames frames_;
  RigShake shake_{0};
  LandmarksAtRest at_rest_{params_, kPointRig, solver_, offset_, shake_};
};

TEST(LandmarksAtRest, TellWhereEachCameraIsEliminatedOrAligned) {
  Street street;
  street.see(0);
  for (int frame = 1; frame < 20; ++frame) {
    street.see(frame);
    EXPECT_LT(street.error_m(frame), 0.1) << frame;
  }
}

TEST(LandmarksAtRest, SeenAgainAreThoseOfTwoFramesAndMore) {
  Street street;
  street.see(0);
  EXPECT_EQ(street.landmarks().seenAgain(), 0);
  street.see(1);
  EXPECT_GT(street.landmarks().seenAgain(), 50);
}

/// Nothing is counted twice: an alignment goes when the landmarks that it used are eliminated.
TEST(LandmarksAtRest, AnEliminationTakesTheAlignmentBack) {
  Street street;
  for (int frame = 0; frame <= 8; ++frame) street.see(frame);
  EXPECT_FALSE(street.landmarks().eliminateAligned(8, street.frames())) << "frame 8 was eliminated";
  const std::size_t of_eliminated = street.factorsOfCamera(8);
  street.see(9);
  EXPECT_TRUE(street.landmarks().eliminateAligned(9, street.frames()));
  street.solver().update();
  EXPECT_LT(street.error_m(9), 0.1);
  EXPECT_EQ(street.factorsOfCamera(9), of_eliminated) << "of the newest camera";
  EXPECT_FALSE(street.landmarks().eliminateAligned(9, street.frames()));
}

TEST(LandmarksAtRest, WithoutPointsNothingTellsIt) {
  Street street(0);
  for (int frame = 0; frame < 6; ++frame) street.see(frame);
  EXPECT_EQ(street.landmarks().seenAgain(), 0);
  EXPECT_GT(street.error_m(5), 0.4);
}

}  // namespace
}  // namespace motorcade
