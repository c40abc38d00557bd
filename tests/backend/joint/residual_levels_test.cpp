#include "backend/joint/residual_levels.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

constexpr LandmarkNoise kGaussian{.loss = RobustLoss::kNone, .variance_freedom = 0};
const Eigen::Vector3d kClaimed(4, 4, 3);

/// Landmarks at rest, seen in each frame of a drive straight ahead with the noise that is claimed, and with an error of
/// their own in each cell.
struct NoisyStreet {
  std::vector<SE3> T_cam_world;
  LandmarkViews landmarks;

  explicit NoisyStreet(double field_sigmas) {
    constexpr int kTimes = 8, kLandmarks = 300;
    test::Noise noise(5);
    for (int k = 0; k < kTimes; ++k) T_cam_world.push_back(SE3(Eigen::Matrix3d::Identity(), {0, 0, -0.5 * k}));
    for (int j = 0; j < kLandmarks; ++j) {
      const Eigen::Vector3d p_world = test::streetPoint(noise, 15, 40);
      for (int k = 0; k < kTimes; ++k)
        if (const auto uvd_px = kRig.project(T_cam_world[k] * p_world)) see(k, *uvd_px, field_sigmas, noise);
      landmarks.first_view.push_back(static_cast<int>(landmarks.views.size()));
    }
  }
  void see(int frame, const Eigen::Vector3d& uvd_px, double field_sigmas, test::Noise& noise) {
    test::Noise of_cell(static_cast<std::uint64_t>(10 * std::floor(5 * uvd_px.y() / kRig.height_px) +
                                                   std::floor(12 * uvd_px.x() / kRig.width_px)));
    const Eigen::Vector3d one = Eigen::Vector3d::Ones(), field = Eigen::Vector3d::Constant(field_sigmas);
    const Eigen::Vector3d sigmas = noise.gaussian(one) + of_cell.gaussian(field);
    landmarks.views.push_back({frame, uvd_px + sigmas.cwiseQuotient(kClaimed), kClaimed});
  }
  ResidualLevels levels() const {
    return residualLevels(kRig, kGaussian, landmarks, FramePose::kWorldCam, T_cam_world, 0);
  }
};

TEST(ResidualLevels, AreThoseOfTheNoise) {
  const ResidualLevels levels = NoisyStreet(0).levels();
  EXPECT_NEAR(levels.uv_sum / levels.uv_count, 1, 0.1);
  EXPECT_NEAR(levels.d_sum / levels.d_count, 1, 0.1);
  EXPECT_EQ(levels.views, 300 * 8);
}

/// The fit of a landmark that stays in one cell takes the cell's error away. The error shows where a landmark goes to
/// another cell.
TEST(ResidualLevels, SeeWhatResidualsInACellHaveInCommon) {
  const auto correlation = [](double field_sigmas) {
    const ResidualLevels levels = NoisyStreet(field_sigmas).levels();
    return levels.neighbor_sum / levels.neighbor_count / ((levels.uv_sum + levels.d_sum) / levels.views);
  };
  EXPECT_LT(std::abs(correlation(0)), 0.01);
  EXPECT_GT(correlation(1), 0.05);
}

/// Compares with counting.
TEST(ResidualLevels, NeighborsAreTheViewsOfOthersInACell) {
  const NoisyStreet street(0);
  const auto cell = [](const LandmarkView& view) {
    return std::pair(std::floor(5 * view.uvd_px.y() / kRig.height_px),
                     std::floor(12 * view.uvd_px.x() / kRig.width_px));
  };
  std::int64_t neighbors = 0;
  const LandmarkViews& landmarks = street.landmarks;
  for (int i = 0; i < landmarks.count(); ++i)
    for (int j = 0; j < landmarks.count(); ++j)
      for (const LandmarkView& a : landmarks.of(i))
        for (const LandmarkView& b : landmarks.of(j)) neighbors += i != j && cell(a) == cell(b) ? 1 : 0;
  EXPECT_NEAR(neighborsPerView(kRig, landmarks),
              static_cast<double>(neighbors) / static_cast<double>(landmarks.views.size()), 1.0);
  EXPECT_EQ(street.levels().neighbor_count / street.levels().views, neighborsPerView(kRig, landmarks));
}

}  // namespace
}  // namespace motorcade
