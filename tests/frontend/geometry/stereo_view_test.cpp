#include "frontend/geometry/stereo_view.hpp"

#include <array>

#include <gtest/gtest.h>

#include "core/robust_loss.hpp"
#include "core/se3.hpp"
#include "tests/frontend/geometry/lane.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using namespace HWY_NAMESPACE;
using test::kRig;
using test::lane;

struct FourPoints {
  SE3 T_cam_ref{expSO3({0.1, -0.2, 0.05}), {0.3, -0.1, 1}};
  std::array<Eigen::Vector3d, kDoubleLanes> p_ref{
      {{1, 2, 10}, {-5, 1, 30}, {0, 0, -8}, {8, -3, 60}}};  // the third lies behind the camera

  Doubles3 lanes() const {
    Doubles3 p{};
    for (std::size_t i = 0; i < kDoubleLanes; ++i) setLane(p, i, p_ref[i]);
    return p;
  }
  StereoViews views() const {
    return viewPoints(kRig, allDoubles(T_cam_ref.rotation()), allDoubles(T_cam_ref.translation()), lanes());
  }
};

TEST(StereoView, IsTheCamerasProjectionInEveryLane) {
  const FourPoints four;
  const StereoViews views = four.views();
  for (std::size_t i = 0; i < kDoubleLanes; ++i) {
    const auto uvd = kRig.project(four.T_cam_ref * four.p_ref[i]);
    EXPECT_EQ(views.ahead[static_cast<int>(i)], uvd ? 1 : 0);
    if (!uvd) continue;
    EXPECT_THAT(lane(views.uvd_px, static_cast<int>(i)), test::IsNear(*uvd, 1e-9));
  }
}

TEST(StereoView, JacobianIsThatOfFiniteDifferences) {
  const FourPoints four;
  const StereoViews views = four.views();
  constexpr double kStep_m = 1e-4;
  for (const int i : {0, 1, 3}) {
    Eigen::Matrix3d J, by_differences;
    J << lane(views.J.x, i).transpose(), lane(views.J.y, i).transpose(), lane(views.J.z, i).transpose();
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d d = kStep_m * Eigen::Vector3d::Unit(axis);
      by_differences.col(axis) =
          (*kRig.project(four.T_cam_ref * (four.p_ref[i] + d)) - *kRig.project(four.T_cam_ref * (four.p_ref[i] - d))) /
          (2 * kStep_m);
    }
    EXPECT_THAT(J, test::IsNear(by_differences, 1e-5));
  }
}

TEST(StereoView, HuberLossIsThatOfTheCore) {
  constexpr std::array kChi2{0.0, 3.9, 4.1, 400.0};
  const Doubles chi2 = load(kChi2.data());
  const HuberLoss loss = huberLoss(chi2, 2);
  for (int i = 0; i < static_cast<int>(kDoubleLanes); ++i) {
    const double norm = std::sqrt(chi2[i]);
    EXPECT_NEAR(loss.weight[i], robustWeight(RobustLoss::kHuber, norm, 2), 1e-12);
    const double huber_cost =
        norm <= 2 ? 0.5 * norm * norm : 2 * (norm - 1);  // quadratic, then linear, for a scale of 2
    EXPECT_NEAR(loss.chi2[i], 2 * huber_cost, 1e-9);
  }
}

}  // namespace
}  // namespace motorcade
