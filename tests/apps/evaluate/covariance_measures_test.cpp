#include "apps/evaluate/measures/covariance_measures.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::Noise;

TEST(AxisReliability, CountsErrorsByTheProbabilityThatTheyAreSmaller) {
  AxisReliability reliability;
  const Vector6d error = (Vector6d() << 0.1, -0.6, 1.3, 0, -1.6, 40).finished();
  reliability.add(error, Matrix6d::Identity());
  for (const auto& [axis, tenth] : {std::pair(0, 0), {1, 4}, {2, 8}, {3, 0}, {4, 8}, {5, 9}})
    EXPECT_EQ(reliability.errors[axis][tenth], 1) << axis;
  EXPECT_EQ(reliability.samples(), 1);
  EXPECT_EQ(reliability.shareWithin(1, 4), 0);
  EXPECT_EQ(reliability.shareWithin(1, 5), 1);
}

/// Rotations claim half of the deviation that they have.
TEST(AxisReliability, FindsAsManyErrorsAsClaimedWhereDeviationsAreRight) {
  Noise noise(5);
  AxisReliability reliability, half;
  constexpr int kErrors = 4000;
  for (int i = 0; i < kErrors; ++i) {
    Vector6d sigma = (Vector6d() << 0.1, 0.2, 0.3, 0.01, 0.02, 0.03).finished();
    Vector6d error;
    for (int axis = 0; axis < 6; ++axis) error[axis] = noise.gaussian(sigma[axis]);
    sigma.tail<3>() /= 2;
    (i % 2 == 0 ? reliability : half).add(error, Matrix6d(sigma.cwiseAbs2().asDiagonal()));
  }
  reliability.add(half);
  EXPECT_EQ(reliability.samples(), kErrors);
  constexpr double kFourSigma = 0.032, kWithinHalfOf80Percent = 0.478;  // P(|z| < 1.2816 / 2)
  for (int axis = 0; axis < 6; ++axis)
    EXPECT_NEAR(reliability.shareWithin(axis, 8), axis < 3 ? 0.8 : kWithinHalfOf80Percent, kFourSigma) << axis;
}

TEST(AxisReliability, ComesBackFromJson) {
  AxisReliability reliability;
  reliability.add(Vector6d::Ones(), Matrix6d::Identity());
  EXPECT_EQ(axisReliabilityOf(nlohmann::json::parse(jsonOf(reliability).dump())).errors, reliability.errors);
  EXPECT_THROW(axisReliabilityOf(nlohmann::json::parse(R"({"x": [1, 2]})")), nlohmann::json::exception);
}

/// Some centimeters and milliradians, correlated.
Matrix6d correlatedCovariance(double scale) {
  Noise noise(3);
  const Vector6d sigma = (Vector6d() << 0.03, 0.02, 0.05, 0.004, 0.003, 0.005).finished();
  return scale * scale * test::randomCovariance<6>(noise, sigma);
}

TEST(ConsistencyOf, CountsDegreesOfFreedomWhereErrorsAreAsLargeAsTheirCovariances) {
  Noise noise(11);
  std::vector<ErrorSample> honest, bold;
  for (int i = 0; i < 4000; ++i) {
    const Matrix6d covariance = correlatedCovariance(0.5 + i % 3);
    honest.push_back({noise.correlated<6>(covariance), covariance});
    bold.push_back({honest.back().xi, covariance / 4});
  }
  const CovarianceErrors errors = consistencyOf(honest);
  constexpr double kOfMean = 0.2, kOfShare = 0.015;  // four sigma of 4000 samples
  EXPECT_EQ(errors.samples, 4000);
  EXPECT_NEAR(errors.pose.mean_nees, 6, kOfMean);
  EXPECT_NEAR(errors.position.mean_nees, 3, kOfMean);
  EXPECT_NEAR(errors.rotation.mean_nees, 3, kOfMean);
  EXPECT_NEAR(errors.pose.median_nees, 5.35, kOfMean);
  for (const NormalizedErrors* of : {&errors.pose, &errors.position, &errors.rotation})
    EXPECT_NEAR(of->coverage_95, 0.95, kOfShare);
  EXPECT_NEAR(consistencyOf(bold).pose.mean_nees, 4 * errors.pose.mean_nees, 1e-6);
  EXPECT_LT(consistencyOf(bold).rotation.coverage_95, 0.65);
  honest.push_back({Vector6d::Ones(), Matrix6d::Zero()});
  EXPECT_EQ(consistencyOf(honest).samples, 4000) << "a covariance of nothing is no covariance";
}

TEST(ErrorsWithoutOffset, LeaveWhatTheCovariancesSayWhateverTheBodyFrames) {
  Noise noise(11);
  const SE3 Y(expSO3({0.3, -1.2, 0.8}), {2, -0.5, 0.7});
  std::vector<SeenTwice> frames;
  for (int i = 0; i < 2000; ++i) {
    const SE3 T_cam_other(expSO3({0, 0.01 * i, 0}), {0.01 * i, 1, 20});
    const Matrix6d P = correlatedCovariance(1), P_other = correlatedCovariance(0.7);
    frames.push_back({T_cam_other * Y * SE3::exp(noise.correlated<6>(P)),
                      T_cam_other * SE3::exp(noise.correlated<6>(P_other)), P, P_other});
  }
  const CovarianceErrors errors = consistencyOf(errorsWithoutOffset(frames));
  EXPECT_NEAR(errors.pose.mean_nees, 6, 0.4);  // four sigma and what the fit takes
  EXPECT_NEAR(errors.pose.coverage_95, 0.95, 0.02);
}

TEST(ErrorsWithoutOffset, AreNotBentByFramesOfWhichLittleIsKnown) {
  std::vector<SeenTwice> frames;
  for (int i = 0; i < 40; ++i) {
    const bool far = i < 30;
    const SE3 error(Eigen::Matrix3d::Identity(), {far ? 1.0 : 0, 0, 0});
    frames.push_back({SE3() * error, SE3(), Matrix6d::Identity() * (far ? 1 : 1e-6)});
  }
  EXPECT_LT(errorsWithoutOffset(frames).back().xi.norm(), 1e-4);
}

TEST(CameraErrorSamples, AreThoseOfTenFramesWithoutTheMounting) {
  const SE3 T_true_cam(expSO3({0, 0.02, 0.01}), {0.1, 0, -0.4});
  std::vector<ComparedFrame> frames;
  CovarianceRows rows;
  for (int i = 0; i < 40; ++i) {
    ComparedFrame frame;
    frame.frame = {100 + i};
    frame.T_world_cam = SE3(expSO3({0, 0.02 * i, 0}), {0, 0, 1.0 * i});
    frame.T_world_cam_true = frame.T_world_cam * T_true_cam.inverse();
    frames.push_back(frame);
    rows.push_back({frame.frame, {}, Matrix6d::Identity()});
  }
  const auto plain = cameraErrorSamples(frames, rows), mounted = cameraErrorSamples(frames, rows, T_true_cam);
  ASSERT_EQ(mounted.size(), 6U) << "frames 110, 115, ... 135";
  for (const auto& sample : mounted) EXPECT_LT(sample.xi.norm(), 1e-9);
  for (const auto& sample : plain) EXPECT_NEAR(sample.xi.head<3>().norm(), 0.2, 0.1);  // ten meters, turned by .02 rad
}

/// A drift of a centimeter per frame.
TEST(CameraPoseSamples, AreErrorsSinceTheFirstFrame) {
  std::vector<ComparedFrame> frames;
  CovarianceRows rows;
  for (int i = 0; i < 21; ++i) {
    ComparedFrame frame;
    frame.frame = {100 + i};
    frame.T_world_cam_true = SE3(expSO3({0, 0.3, 0}), {1, 2, 3.0 + i});
    frame.T_world_cam = frame.T_world_cam_true * SE3(Eigen::Matrix3d::Identity(), {0, 0, 0.5 - 0.01 * i});
    frames.push_back(frame);
    rows.push_back({frame.frame, {}, Matrix6d::Identity()});
  }
  const auto samples = cameraPoseSamples(frames, rows);
  ASSERT_EQ(samples.size(), 4U) << "frames 105, 110, 115, 120";
  for (std::size_t k = 0; k < samples.size(); ++k)
    EXPECT_THAT(Eigen::Vector3d(samples[k].xi.head<3>()),
                test::IsNear(Eigen::Vector3d(0, 0, 0.05 * (static_cast<double>(k) + 1)), 1e-9));
}

/// A run with independent errors in every pose, and the covariances that they have.
RunFolder noisyRun(int seed, double claimed, const std::vector<std::int64_t>& track_of_object) {
  Noise noise(seed);
  const Matrix6d P = correlatedCovariance(1);
  RunFolder run;
  const auto motionOver = [](int frames) { return SE3(Eigen::Matrix3d::Identity(), {0, 0, 1.0 * frames}); };
  const Matrix6d before = motionOver(kCameraCovarianceFrames).inverse().adjoint();
  for (int i = 0; i < 800; ++i) {
    const FrameId frame{i};
    run.online.camera.push_back(motionOver(i) * SE3::exp(noise.correlated<6>(P)));
    if (i >= kCameraCovarianceFrames)
      run.online.covariances.push_back({frame, {}, claimed * (P + before * P * before.transpose())});
    for (std::size_t k = 0; k < track_of_object.size(); ++k) {
      // Body frames of the runs differ by a constant, some centimeters and a turn.
      const SE3 T_cam_body = SE3(expSO3({0, 0.3, 0}), {8.0 * static_cast<double>(k), 1, 15}) *
                             SE3(expSO3({0.1 * seed, 0, 0.2}), {0.1 * seed, 0, 0}) * SE3::exp(noise.correlated<6>(P));
      RunFolder::ObjectRow row{frame, {}};
      row.object.track = {track_of_object[k]};
      row.object.T_world_body = run.online.camera.back() * T_cam_body;
      run.online.objects.push_back(row);
      run.online.covariances.push_back({frame, row.object.track, claimed * P});
    }
  }
  return run;
}

TEST(CompareHalves, FindsHonestCovariancesHonestAndBoldOnesBold) {
  const RunFolder b = noisyRun(2, 1, {5, 4});
  const HalfErrors honest = compareHalves(noisyRun(1, 1, {4, 7, 9}), b);
  EXPECT_EQ(honest.camera.samples, 158);
  EXPECT_EQ(honest.objects.samples, 320) << "two objects; the third is seen by one run alone";
  constexpr double kFourSigma = 1.2;  // of the mean of 158 samples of 6 degrees of freedom
  EXPECT_NEAR(honest.camera.pose.mean_nees, 6, kFourSigma);
  EXPECT_NEAR(honest.objects.pose.mean_nees, 6, kFourSigma);
  const HalfErrors bold = compareHalves(noisyRun(1, 0.1, {4, 7, 9}), noisyRun(2, 0.1, {5, 4}));
  EXPECT_GT(bold.camera.pose.mean_nees, 40);
  EXPECT_GT(bold.objects.pose.mean_nees, 40);
}

}  // namespace
}  // namespace motorcade
