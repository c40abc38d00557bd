#include "core/stereo_camera.hpp"

#include <array>
#include <functional>

#include <gtest/gtest.h>

#include "core/se3.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::numericJacobian;

const StereoCamera kCamera{721.5, 718.0, 609.6, 172.9, 0.5372, 1242, 375};
const Eigen::Vector3d kPoint_cam{-3.2, 1.1, 17.5};

TEST(StereoCamera, TriangulationInvertsProjection) {
  EXPECT_THAT(kCamera.triangulate(*kCamera.project(kPoint_cam)), IsNear(kPoint_cam, 1e-10));
}

TEST(StereoCamera, PointsBehindTheCameraDoNotProject) { EXPECT_FALSE(kCamera.project({0.5, 0.2, -4.0})); }

TEST(StereoCamera, JacobiansMatchFiniteDifferences) {
  const auto project = [](const Eigen::Vector3d& p) { return *kCamera.project(p); };
  EXPECT_THAT(kCamera.projectionJacobian(kPoint_cam), IsNear(numericJacobian(project, kPoint_cam), 1e-6));
  const Eigen::Vector3d uvd_px = project(kPoint_cam);
  const auto triangulate = [](const Eigen::Vector3d& z) { return kCamera.triangulate(z); };
  EXPECT_THAT(kCamera.triangulationJacobian(uvd_px), IsNear(numericJacobian(triangulate, uvd_px), 1e-6));
}

const StereoCamera kNominal{721.5, 718.0, 609.6, 172.9, 0.5372, 1242, 375};

/// One camera with Brown's distortion, as a calibration would have it.
struct Lens {
  double focal = 1, middle_x_px = 0, middle_y_px = 0, k1 = 0, p1 = 0, p2 = 0;

  Eigen::Vector2d project(const Eigen::Vector3d& p_cam) const {
    const double x = p_cam.x() / p_cam.z(), y = p_cam.y() / p_cam.z(), r2 = x * x + y * y;
    return {focal * kNominal.fx_px * (x * (1 + k1 * r2) + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + kNominal.cx_px +
                middle_x_px,
            focal * kNominal.fy_px * (y * (1 + k1 * r2) + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + kNominal.cy_px +
                middle_y_px};
  }
};

/// A rig that is off the calibration `kNominal`.
struct Rig {
  Lens left, right;
  double baseline_m = kNominal.baseline_m;
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();  // of the right camera

  Eigen::Vector3d observe(const Eigen::Vector3d& p_cam) const {
    const Eigen::Vector2d uv_px = left.project(p_cam);
    const Eigen::Vector3d p_right = expSO3(turn_rad).transpose() * (p_cam - Eigen::Vector3d(baseline_m, 0, 0));
    return {uv_px.x(), uv_px.y(), uv_px.x() - right.project(p_right).x()};
  }
};

TEST(CalibrationErrors, ShiftObservationsAsProjectionByARigWithTheseErrorsDoes) {
  constexpr double kPart = 1e-3;  // of the standard deviations: of first order
  const CalibrationSigmas sigmas;
  const auto both = [](double Lens::*value, double error) {
    return [=](Rig& rig) { rig.left.*value += error, rig.right.*value += error; };
  };
  const auto turned = [](int axis, double angle_rad) { return [=](Rig& rig) { rig.turn_rad[axis] += angle_rad; }; };
  const auto right = [](double Lens::*value, double error) { return [=](Rig& rig) { rig.right.*value += error; }; };
  const double f = kNominal.fx_px;
  const std::array<std::function<void(Rig&)>, kCalibrationErrors> errors{
      both(&Lens::focal, kPart * sigmas.focal),
      both(&Lens::middle_x_px, kPart * sigmas.middle_px),
      both(&Lens::middle_y_px, kPart * sigmas.middle_px),
      both(&Lens::k1, kPart * sigmas.distortion),
      both(&Lens::p1, kPart * 0.1 * sigmas.distortion),
      both(&Lens::p2, kPart * 0.1 * sigmas.distortion),
      [&](Rig& rig) { rig.baseline_m *= 1 + kPart * sigmas.baseline; },
      turned(1, -kPart * sigmas.disparity_px / f),
      turned(2, kPart * sigmas.disparity_px / 3 / f),
      turned(0, kPart * 2 * sigmas.disparity_px / 3 / f),
      right(&Lens::focal, kPart * 2 * sigmas.disparity_px / 3 / f),
      right(&Lens::k1, kPart * 4 * sigmas.disparity_px / 3 / f)};
  for (const Eigen::Vector3d& p_cam : {Eigen::Vector3d(-6.5, 1.4, 9.5), Eigen::Vector3d(9.0, -3.1, 31.0)}) {
    const Eigen::Vector3d without = Rig{}.observe(p_cam);
    for (int k = 0; k < kCalibrationErrors; ++k) {
      Rig rig;
      errors[k](rig);
      const Eigen::Vector3d with = rig.observe(p_cam);
      EXPECT_THAT(Eigen::Vector3d(kPart * observationShifts(kNominal, sigmas, with).col(k)),
                  IsNear(Eigen::Vector3d(without - with), 2e-5 * kPart * kNominal.fx_px))
          << "error " << k;
    }
  }
}

}  // namespace
}  // namespace motorcade
