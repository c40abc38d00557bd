#include "backend/solver/fluid_relinearization.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include <gtest/gtest.h>

#include "backend/factors/pose_factors.hpp"
#include "backend/factors/twist_factors.hpp"
#include "backend/joint/bundle_factor.hpp"
#include "backend/solver/incremental_solver.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

const StereoCamera kCamera{
    .fx_px = 720, .fy_px = 720, .cx_px = 620, .cy_px = 188, .baseline_m = 0.54, .width_px = 1242, .height_px = 376};
constexpr int kPathPoses = 40, kSeenIn = 3;

SE3 cameraAt(int k) { return SE3(expSO3({0, 0.01 * k, 0}), {0.1 * k, 0, 0.9 * k}); }

/// Landmarks that were seen from the camera's poses up to the k-th.
EliminatedLandmarks landmarksAt(int k, test::Noise& noise) {
  const Eigen::Vector3d sigma_px(0.2, 0.2, 0.2);
  LandmarkViews landmarks;
  std::vector<SE3> T_cam_world;
  for (int i = 0; i < kSeenIn; ++i) T_cam_world.push_back(cameraAt(k - kSeenIn + 1 + i).inverse());
  for (int j = 0; j < 30; ++j) {
    const Eigen::Vector3d p_world = cameraAt(k) * noise.inBox({-5, -1, 10}, {5, 1, 30});
    for (int i = 0; i < kSeenIn; ++i) {
      const Eigen::Vector3d uvd_px = *kCamera.project(T_cam_world[i] * p_world) + noise.gaussian(sigma_px);
      landmarks.views.push_back({i, uvd_px, {5, 5, 5}});
    }
    landmarks.first_view.push_back(static_cast<int>(landmarks.views.size()));
  }
  return eliminateLandmarks(kCamera, {.variance_freedom = 0}, landmarks, FramePose::kWorldCam, std::move(T_cam_world),
                            0);
}

/// The models of a few quadratics are off; others share nothing with them but a vector, in which they are right.
TEST(FluidRelinearization, LeavesQuadraticsAloneThatShareAVectorOnly) {
  IncrementalSolver::Params params;
  params.relinearization = {.mismatch_tolerance = 0.05,
                            .jacobian_drift_sigmas = 0.5,
                            .urgent_flops = std::numeric_limits<double>::infinity(),
                            .polish_flops = std::numeric_limits<double>::infinity()};
  IncrementalSolver solver(params);
  test::Noise noise(1);
  const SmallVector zero = SmallVector::Zero(1);
  const VariableId offset = solver.addVariable(zero);
  solver.addFactor(std::make_unique<VectorPriorFactor>(offset, zero, SmallVector::Constant(1, 1e-3)));
  std::vector<VariableId> x;
  for (int k = 0; k < kPathPoses; ++k) {
    x.push_back(solver.addVariable(cameraAt(k)));
    const PoseNoise sure{.sqrt_information = 1e3 * Matrix6d::Identity()};
    if (k == 0) solver.addFactor(std::make_unique<PriorFactor>(std::array{x[0]}, PriorModel{cameraAt(0)}, sure));
    if (k == 1)
      solver.addFactor(std::make_unique<MotionFactor>(std::array{x[0], x[1]}, MotionModel{cameraAt(1)}, sure));
    if (k >= kSeenIn - 1)
      solver.addFactor(
          std::make_unique<BundleFactor>(std::vector(x.end() - kSeenIn, x.end()), offset, landmarksAt(k, noise)));
    solver.update();
  }
  const SE3 elsewhere =
      cameraAt(kPathPoses - 2).inverse() * cameraAt(kPathPoses - 1) * SE3(expSO3({0, 0.1, 0}), {0.6, 0, 0});
  const PoseNoise very_sure{.sqrt_information = 1e5 * Matrix6d::Identity()};
  solver.addFactor(std::make_unique<MotionFactor>(std::array{x[kPathPoses - 2], x[kPathPoses - 1]},
                                                  MotionModel{elsewhere}, very_sure));
  int relinearized = 0;
  for (int i = 0; i < 5; ++i) relinearized = std::max(relinearized, solver.update().relinearized_factors);
  EXPECT_GT(relinearized, 0);
  EXPECT_LT(relinearized, kPathPoses / 2);
}

/// A pose is turned, ten meters away from another that follows.
int modelsCorrectedAfterATurn(IncrementalSolver::Lifetime lifetime) {
  IncrementalSolver::Params params;
  params.relinearization.relinearize_rad = params.relinearization.leisurely_rad = 1;  // residuals alone
  params.relinearization.jacobian_drift_sigmas = 1e3;
  params.iterations_per_update = 1;
  IncrementalSolver solver(params);
  const SE3 ahead(Eigen::Matrix3d::Identity(), {10, 0, 0});
  const std::array x{solver.addVariable(SE3{}), solver.addVariable(ahead)};
  const PoseNoise sure{.sqrt_information = 1e3 * Matrix6d::Identity()};
  solver.addFactor(
      std::make_unique<PriorFactor>(std::array{x[0]}, PriorModel{SE3(expSO3({0, 0, 0.03}), {0, 0, 0})}, sure));
  solver.addFactor(std::make_unique<MotionFactor>(x, MotionModel{ahead}, sure), lifetime);
  solver.update();
  return solver.update().corrected_factors;
}

TEST(FluidRelinearization, NobodyLooksAtTheModelOfAProvisionalFactor) {
  EXPECT_EQ(modelsCorrectedAfterATurn(IncrementalSolver::Lifetime::kLasting), 1);
  EXPECT_EQ(modelsCorrectedAfterATurn(IncrementalSolver::Lifetime::kProvisional), 0);
}

}  // namespace
}  // namespace motorcade
