#include "backend/joint/known_landmarks.hpp"

#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "backend/graph/variable.hpp"
#include "tests/backend/unpacked.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::kRig;

const Eigen::Vector3d kInverseSigma(4, 4, 3);
const LandmarkNoise kNoise{.loss = RobustLoss::kNone, .variance_freedom = 0, .shared_disparity_sigma_px = 0.5};
constexpr double kOffset_px = 0.3;

/// Points at rest that a camera on its way sees twice, without noise.
struct PointsSeenTwice {
  std::array<SE3, 2> T_cam_world;
  std::vector<std::array<Eigen::Vector3d, 2>> uvd_px;

  explicit PointsSeenTwice(int points = 30) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const SE3 x_first(expSO3({0.1, 0.2, 0.3}), {5, 1, 2});
    const SE3 motion = SE3::exp((Vector6d() << 0.1, 0.02, 1.1, 0.01, 0.02, 0.005).finished());
    T_cam_world = {x_first.inverse(), (x_first * motion).inverse()};
    for (int j = 0; j < points; ++j) {
      const Eigen::Vector3d p_first(6 * uniform(random), 2 * uniform(random), 16 + 8 * uniform(random));
      uvd_px.push_back({*kRig.project(p_first), *kRig.project(motion.inverse() * p_first)});
      for (Eigen::Vector3d& view : uvd_px.back()) view.z() -= kOffset_px;
    }
  }
  std::vector<ViewOfKnown> views() const {
    std::vector<ViewOfKnown> views;
    LandmarkFit fit(kRig, kNoise, FramePose::kWorldCam, T_cam_world, kOffset_px);
    for (const auto& [first, last] : uvd_px) {
      const LandmarkView view{0, first, kInverseSigma};
      EXPECT_TRUE(fit(std::span(&view, 1)));
      views.push_back({fit.known().value(), last, kInverseSigma});
    }
    return views;
  }
  EliminatedLandmarks align(const std::array<SE3, 2>& poses) const {
    return alignToKnown(kRig, kNoise, views(), poses, kOffset_px);
  }
};

/// A landmark that one view has told, and whose second view is a measurement, equals the elimination of two views.
TEST(KnownLandmarks, TellWhatTheEliminationOfTwoViewsDoes) {
  const PointsSeenTwice scene;
  LandmarkViews landmarks;
  for (const auto& views : scene.uvd_px) {
    for (int k = 0; k < 2; ++k) landmarks.views.push_back({k, views[k], kInverseSigma});
    landmarks.first_view.push_back(static_cast<int>(landmarks.views.size()));
  }
  const auto eliminated = eliminateLandmarks(kRig, kNoise, landmarks, FramePose::kWorldCam,
                                             {scene.T_cam_world[0], scene.T_cam_world[1]}, kOffset_px);
  const Matrix6d H = test::unpacked(eliminated.system).topLeftCorner<6, 6>(),
                 of_known = test::unpacked(scene.align(scene.T_cam_world).system).topLeftCorner<6, 6>();
  EXPECT_THAT(Matrix6d(of_known / H.norm()), IsNear(Matrix6d(H / H.norm()), 1e-9));
}

TEST(KnownLandmarks, GiveBackTheMotion) {
  const PointsSeenTwice scene;
  const Vector6d displacement = (Vector6d() << 0.02, -0.01, 0.05, 0.002, -0.001, 0.003).finished();
  const Value x_first = scene.T_cam_world[0].inverse();
  const auto aligned = scene.align({std::get<SE3>(displaced(x_first, -displacement)).inverse(), scene.T_cam_world[1]});
  const Matrix6d H = test::unpacked(aligned.system).topLeftCorner<6, 6>();
  const Vector6d g = test::unpacked(aligned.system).topRightCorner<6, 1>(), step = -H.llt().solve(g);
  EXPECT_THAT(step, IsNear(displacement, 3e-3));
  EXPECT_LT((step - displacement).norm(), 0.1 * displacement.norm());
  EXPECT_LT(test::unpacked(scene.align(scene.T_cam_world).system).rightCols<1>().norm(), 1e-6);
}

TEST(KnownLandmarks, CountLessWhereTheyAreKnownLess) {
  const PointsSeenTwice scene;
  std::vector<ViewOfKnown> sure = scene.views();
  for (ViewOfKnown& view : sure) view.landmark.covariance *= 0.1;
  const Matrix6d H = test::unpacked(scene.align(scene.T_cam_world).system).topLeftCorner<6, 6>();
  const Matrix6d more =
      test::unpacked(alignToKnown(kRig, kNoise, sure, scene.T_cam_world, kOffset_px).system).topLeftCorner<6, 6>();
  EXPECT_GT((more - H).llt().matrixL().toDenseMatrix().diagonal().minCoeff(), 0);
  EXPECT_GT(more(2, 2), 2 * H(2, 2));
}

/// A view measures motion and shake, and the shake is eliminated.
TEST(KnownLandmarks, TellTheShakeOfTheNewestFrame) {
  constexpr double kShake_px = 0.2, kSigma_px = 0.5;
  PointsSeenTwice scene(200);
  for (auto& views : scene.uvd_px) views[1].z() -= kShake_px;
  LandmarkNoise shaken = kNoise;
  shaken.shake_sigma_px = kSigma_px;
  const auto aligned = alignToKnown(kRig, shaken, scene.views(), scene.T_cam_world, kOffset_px);
  ASSERT_EQ(aligned.shakes.size(), 2U);
  EXPECT_NEAR(aligned.shakes[1].px, kShake_px, 0.01);
  const Matrix6d H = test::unpacked(aligned.system).topLeftCorner<6, 6>(),
                 rigid = test::unpacked(scene.align(scene.T_cam_world).system).topLeftCorner<6, 6>();
  const auto pull = [](const EliminatedLandmarks& of) {
    return test::unpacked(of.system).topRightCorner<6, 1>().norm();
  };
  EXPECT_LT(pull(aligned), 0.1 * pull(scene.align(scene.T_cam_world)));
  EXPECT_GT(H.llt().matrixL().toDenseMatrix().diagonal().minCoeff(), 0);
  EXPECT_LT(H(2, 2), rigid(2, 2));
  EXPECT_GT((rigid - H).trace(), 0);
}

TEST(KnownLandmarks, BehindTheCameraAreLeftOut) {
  const PointsSeenTwice scene(1);
  std::vector<ViewOfKnown> views = scene.views();
  const SE3 beyond = SE3(Eigen::Matrix3d::Identity(), {0, 0, -100}) * scene.T_cam_world[1];
  const auto behind = alignToKnown(kRig, kNoise, views, {scene.T_cam_world[0], beyond}, kOffset_px);
  EXPECT_EQ(test::unpacked(behind.system).norm(), 0);
  views[0].landmark.unknowns[2] = 0;
  EXPECT_EQ(test::unpacked(alignToKnown(kRig, kNoise, views, scene.T_cam_world, kOffset_px).system).norm(), 0);
}

}  // namespace
}  // namespace motorcade
