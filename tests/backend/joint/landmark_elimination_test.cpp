#include "backend/joint/landmark_elimination.hpp"

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/backend/unpacked.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

constexpr int kPoses = 6;
constexpr double kStreetOffset_px = 0.3;

/// Landmarks at rest, seen by a camera that drives past them in most of its frames.
struct ShakenStreet {
  std::vector<SE3> T_cam_world;
  LandmarkViews landmarks;

  /// `shakes_px` of each frame, or none.
  explicit ShakenStreet(int count, std::vector<double> shakes_px = {}, double noise_px = 0.25) {
    test::Noise noise(4);
    const Eigen::Vector3d sigma_px = Eigen::Vector3d::Constant(noise_px);
    shakes_px.resize(kPoses);
    for (int k = 0; k < kPoses; ++k)
      T_cam_world.push_back(SE3::exp((Vector6d() << 0.1, 0.02, 1.1, 0.01, 0.02, 0.005).finished() * k).inverse());
    for (int j = 0; j < count; ++j) {
      const Eigen::Vector3d p_world = test::streetPoint(noise, 10, 40);
      for (int k = j % 3; k < kPoses; ++k) {
        const auto uvd_px = kRig.project(T_cam_world[k] * p_world);
        if (!uvd_px || j % 5 == k) continue;
        const Eigen::Vector3d error_px =
            noise.gaussian(sigma_px) - Eigen::Vector3d(0, 0, kStreetOffset_px + shakes_px[k]);
        landmarks.views.push_back({k, *uvd_px + error_px, {4, 4, 3}});
      }
      landmarks.first_view.push_back(static_cast<int>(landmarks.views.size()));
    }
  }
  EliminatedLandmarks eliminate(const LandmarkNoise& noise) const {
    return eliminateLandmarks(kRig, noise, landmarks, FramePose::kWorldCam, T_cam_world, kStreetOffset_px);
  }
};

/// [H g; g' c] of one landmark after the other, by the textbook, in (poses, shakes, offset).
Eigen::MatrixXd eliminatedOneByOne(const ShakenStreet& street, const LandmarkNoise& noise) {
  constexpr Eigen::Index kOfPoses = 6 * kPoses, kAll = 7 * kPoses;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(kAll + 2, kAll + 2);
  LandmarkFit fit(kRig, noise, FramePose::kWorldCam, street.T_cam_world, kStreetOffset_px);
  for (int j = 0; j < street.landmarks.count(); ++j) {
    const auto views = street.landmarks.of(j);
    if (!fit(views)) continue;
    const auto rows = static_cast<Eigen::Index>(3 * views.size() + 1);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, kAll + 2), B = Eigen::MatrixXd::Zero(rows, 4);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(3 * i);
      const LinearView& linear = fit.views()[i];
      A.block<3, 6>(row, 6 * views[i].frame) = linear.J.leftCols<6>();
      A.block<3, 1>(row, kOfPoses + views[i].frame) = linear.J.col(6);
      A.block<3, 2>(row, kAll) = linear.J.rightCols<2>();
      B.middleRows<3>(row) = linear.B;
    }
    A(rows - 1, kAll + 1) = fit.sharedError_px() / fit.sharedErrorSigma_px();
    B(rows - 1, 3) = 1 / fit.sharedErrorSigma_px();
    system += A.transpose() * A - A.transpose() * B * (B.transpose() * B).inverse() * B.transpose() * A;
  }
  return system;
}

/// Rows and columns of the poses, the offset and the right-hand side.
Eigen::MatrixXd withoutShakes(const Eigen::MatrixXd& system) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = 0; row < system.rows(); ++row)
    if (row < 6 * kPoses || row >= 7 * kPoses) rows.push_back(row);
  return system(rows, rows);
}

/// Tests with more landmarks than are subtracted at a time.
TEST(LandmarkElimination, IsThatOfOneByOne) {
  const ShakenStreet street(60);
  const Eigen::MatrixXd expected = withoutShakes(eliminatedOneByOne(street, {}));
  const EliminatedLandmarks eliminated = street.eliminate({});
  EXPECT_LT((test::unpacked(eliminated.system) - expected).norm(), 1e-10 * expected.norm());
  EXPECT_TRUE(eliminated.shakes.empty());
}

TEST(LandmarkElimination, TakesTheShakesOutNext) {
  const ShakenStreet street(60, {0.2, -0.1, 0.05, 0, 0.15, -0.2});
  const LandmarkNoise noise{.shake_sigma_px = 0.1};
  Eigen::MatrixXd all = eliminatedOneByOne(street, noise);
  const Eigen::MatrixXd held = 1e3 * Eigen::MatrixXd::Ones(kPoses, kPoses) + Eigen::MatrixXd::Identity(kPoses, kPoses);
  all.block<kPoses, kPoses>(6 * kPoses, 6 * kPoses) += held / (0.1 * 0.1);
  const Eigen::MatrixXd of_shakes = all.block<kPoses, kPoses>(6 * kPoses, 6 * kPoses),
                        by_shakes = all.middleCols<kPoses>(6 * kPoses);
  const Eigen::MatrixXd expected = withoutShakes(all - by_shakes * of_shakes.inverse() * by_shakes.transpose());
  const EliminatedLandmarks eliminated = street.eliminate(noise);
  EXPECT_LT((test::unpacked(eliminated.system) - expected).norm(), 1e-8 * expected.norm());
  const Eigen::VectorXd px = -of_shakes.inverse() * by_shakes.transpose().rightCols<1>();
  ASSERT_EQ(eliminated.shakes.size(), kPoses);
  for (int k = 0; k < kPoses; ++k) {
    EXPECT_NEAR(eliminated.shakes[k].px, px[k], 1e-9);
    EXPECT_NEAR(eliminated.shakes[k].variance_px2, of_shakes.inverse()(k, k), 1e-12);
  }
}

TEST(LandmarkElimination, FindsHowFramesShake) {
  const std::vector<double> truth{0.2, -0.1, 0.05, -0.1, 0.15, -0.2};
  ShakenStreet street(400, truth, 0.1);
  const LandmarkNoise noise{.shake_sigma_px = 1};
  for (const FrameShake& shake : street.eliminate(noise).shakes) street.landmarks.shakes_px.push_back(shake.px);
  for (LandmarkView& view : street.landmarks.views) view.uvd_px.z() += street.landmarks.shakes_px[view.frame];
  const auto shakes = street.eliminate(noise).shakes;  // robust weights follow what is known
  for (int k = 0; k < kPoses; ++k) EXPECT_NEAR(shakes[k].px, truth[k], 0.03) << k;
}

TEST(LandmarkElimination, WhatAllFramesShareIsNoShake) {
  double sum_px = 0;
  for (const FrameShake& shake : ShakenStreet(60, std::vector(kPoses, 0.2)).eliminate({.shake_sigma_px = 0.1}).shakes)
    sum_px += shake.px;
  EXPECT_NEAR(sum_px, 0, 0.01);
}

/// Poses that all move as one leave the system as it is, with shakes, too.
TEST(LandmarkElimination, KnowsNothingOfWhereTheWholeIs) {
  const ShakenStreet street(60, {0.2, -0.1, 0.05, 0, 0.15, -0.2});
  const Eigen::MatrixXd system = test::unpacked(street.eliminate({.shake_sigma_px = 0.1}).system);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(system.rows());
    for (int k = 0; k < kPoses; ++k) all[6 * k + axis] = 1;
    EXPECT_LT((system * all).norm(), 1e-9 * system.norm());
  }
}

}  // namespace
}  // namespace motorcade
