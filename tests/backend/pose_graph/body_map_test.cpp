#include "backend/pose_graph/body_map.hpp"

#include <gtest/gtest.h>

#include "tests/backend/point_drive.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::kPointRig;

const SE3 kT_cam_body(Eigen::Matrix3d::Identity(), {0, 0, 20});
const Eigen::Vector3d kPoint(1, 0.5, 1);
bool any(PointId) { return true; }

/// The map after some views of one point from the same place.
SeenPoint mapped(int views, double sigma_px, const Matrix6d& pose_covariance, std::uint64_t seed = 1) {
  test::Noise noise(seed);
  BodyMap map;
  std::vector<PointMeasurement> points(1);
  for (int frame = 0; frame < views; ++frame) {
    const Eigen::Vector3d sigma = Eigen::Vector3d::Constant(sigma_px);
    const Eigen::Vector3d seen_px = *kPointRig.project(kT_cam_body * kPoint) + noise.gaussian(sigma);
    points[0] = {{7}, seen_px.cast<float>(), sigma.cast<float>()};
    map.update(kPointRig, {{frame}, points, 0, kT_cam_body}, pose_covariance);
  }
  const auto seen = map.seenIn({{views}, points, 0, kT_cam_body}, any);
  return seen.at(0);
}

TEST(BodyMap, APointEntersWhereItWasTriangulated) {
  const SeenPoint point = mapped(1, 1e-6, Matrix6d::Zero());
  EXPECT_THAT(point.p_ref, test::IsNear(kPoint, 1e-3));  // pixels are floats
}

TEST(BodyMap, FurtherViewsMakeItBetter) {
  constexpr int kSeeds = 100;
  double once = 0, often = 0, nees = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const SeenPoint first = mapped(1, 0.1, Matrix6d::Zero(), seed), later = mapped(16, 0.1, Matrix6d::Zero(), seed);
    once += (first.p_ref - kPoint).squaredNorm() / kSeeds;
    often += (later.p_ref - kPoint).squaredNorm() / kSeeds;
    nees += test::nees(Eigen::Vector3d(later.p_ref - kPoint), later.covariance_ref) / kSeeds;
  }
  EXPECT_LT(often, 0.15 * once);  // a sixteenth, and what triangulation is not linear
  EXPECT_NEAR(nees, 3, 1.5 * test::meanChi2Spread(3, kSeeds));
}

TEST(BodyMap, AnUnsurePoseCountsInEveryStep) {
  const Matrix6d unsure = 0.01 * Matrix6d::Identity();
  EXPECT_GT(mapped(1, 0.1, unsure).covariance_ref.trace(), mapped(1, 0.1, Matrix6d::Zero()).covariance_ref.trace());
  EXPECT_GT(mapped(8, 0.1, unsure).covariance_ref.trace(), 2 * mapped(8, 0.1, Matrix6d::Zero()).covariance_ref.trace());
}

TEST(BodyMap, ForgetsWhatIsNotSeenForAWhile) {
  BodyMap map;
  const Eigen::Vector3d uvd_px = *kPointRig.project(kT_cam_body * kPoint);
  const std::vector<PointMeasurement> points{{{7}, uvd_px.cast<float>(), Eigen::Vector3f::Constant(0.25F)}};
  map.update(kPointRig, {{0}, points, 0, kT_cam_body}, Matrix6d::Zero());
  for (int frame = 1; frame <= 10; ++frame) map.update(kPointRig, {{frame}, {}, 0, kT_cam_body}, Matrix6d::Zero());
  EXPECT_TRUE(map.seenIn({{11}, points, 0, kT_cam_body}, any).empty());
}

}  // namespace
}  // namespace motorcade
