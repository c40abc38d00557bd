#include "backend/joint/landmark_bundles.hpp"

#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "backend/factors/pose_factors.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

constexpr int kFrames = 80, kPoints = 25;

SE3 truthIn(int frame) { return {expSO3({0, 0.002 * frame, 0}), {1, 1, 24 - 0.15 * frame}}; }

LandmarkBundles::Params paramsOfAnObject() {
  LandmarkBundles::Params params;
  params.pose = FramePose::kCamBody;
  params.points.max_views = 14;
  params.points.oldest_kept_frames = 64;
  params.points.image_width_px = kRig.width_px;
  params.points.image_height_px = kRig.height_px;
  params.newest = IncrementalSolver::Lifetime::kProvisional;
  params.from_estimates = false;
  return params;
}

/// A body whose points are followed over a drive, with poses that begin a decimeter beside where they are.
class FollowedBody {
 public:
  explicit FollowedBody(int window_frames) : window_frames_(window_frames) {
    for (int i = 0; i < kPoints; ++i) points_.push_back(noise_.inBox({-1, -0.7, -2}, {1, 0.7, 2}));
  }

  void see(int frame) {
    const SE3 beside(SE3().rotation(), noise_.gaussian(Eigen::Vector3d(0.1, 0.1, 0.1)));
    const SE3 expected = frame == 0 ? truthIn(0) : beside * truthIn(frame);
    const VariableId pose = poses_[{frame}] = solver_.addVariable(expected);
    const double sigma = frame == 0 ? 1e-3 : 1;
    solver_.addFactor(priorFactor(pose, expected, poseSigmas(sigma, sigma, sigma)));
    std::vector<PointMeasurement> seen;
    for (int i = 0; i < kPoints; ++i)
      if (const auto uvd_px = test::look(truthIn(frame) * points_[i], noise_))
        seen.push_back({{i}, uvd_px->cast<float>(), test::kObservationSigma_px.cast<float>()});
    bundles_.points().observe({frame}, seen);
    bundles_.renew(frame, poseVariable(), {frame - window_frames_});
    EXPECT_TRUE(solver_.update().problems.empty()) << frame;
    while (static_cast<int>(poses_.size()) > window_frames_) retireOldest();
  }
  /// Root mean square error over the frames that the graph holds.
  double error_m() const {
    double squares = 0;
    for (const auto& [frame, pose] : poses_)
      squares +=
          (solver_.pose(pose).translation() - truthIn(static_cast<int>(frame.value)).translation()).squaredNorm();
    return std::sqrt(squares / static_cast<double>(poses_.size()));
  }

 private:
  PoseVariable poseVariable() const {
    return [this](FrameId frame) {
      const auto pose = poses_.find(frame);
      return pose == poses_.end() ? VariableId{} : pose->second;
    };
  }
  void retireOldest() {
    const auto [frame, pose] = *poses_.begin();
    bundles_.retire(frame);
    solver_.retire(std::vector{pose});
    poses_.erase(frame);
  }

  int window_frames_;
  test::Noise noise_{3};
  std::vector<Eigen::Vector3d> points_;
  IncrementalSolver solver_{{}};
  RigOffset offset_{solver_, 1.0};
  std::map<FrameId, VariableId> poses_;
  RigShake shake_{0};
  LandmarkBundles bundles_{paramsOfAnObject(), NoiseLevel{}, kRig, solver_, offset_, shake_};
};

double errorAfterTheDrive_m(int window_frames) {
  FollowedBody body(window_frames);
  for (int frame = 0; frame < kFrames; ++frame) body.see(frame);
  return body.error_m();
}

TEST(LandmarkBundles, HoldABodyWhereItsPointsAreSeen) { EXPECT_LT(errorAfterTheDrive_m(kFrames), 0.08); }

/// Tracks reach farther back than the window.
TEST(LandmarkBundles, HoldItInAWindowThatIsShorterThanItsTracks) { EXPECT_LT(errorAfterTheDrive_m(20), 0.1); }

}  // namespace
}  // namespace motorcade
