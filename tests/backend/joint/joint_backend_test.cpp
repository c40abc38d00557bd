#include "backend/joint/joint_backend.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/filter/filter_backend.hpp"
#include "backend/pose_graph/pose_graph_backend.hpp"
#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::kStreet;
using test::PointDrive;

/// Mean distance of the camera from where it was.
double cameraError_m(const std::vector<FrameEstimate>& finals, const test::SimulatedDrive& truth) {
  double sum = 0;
  for (const FrameEstimate& f : finals)
    sum += (f.T_world_cam.translation() - truth.camera(static_cast<int>(f.head.frame.value)).translation()).norm();
  return sum / static_cast<double>(finals.size());
}

struct Errors {
  double camera_m = 0, position_m = 0, step_m = 0;
};

template <class Make>
Errors errorsOf(const Make& make, const PointDrive::Options& options) {
  constexpr int kSeeds = 3;
  Errors errors;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    PointDrive drive(seed, options);
    const auto backend = make();
    const auto finals = test::runDrive(*backend, drive).finals;
    errors.camera_m += cameraError_m(finals, drive.truth()) / kSeeds;
    errors.position_m += test::objectError_m(finals, drive.truth()) / kSeeds;
    errors.step_m += test::stepError_m(finals, drive.truth()) / kSeeds;
  }
  std::cout << "camera " << errors.camera_m << " m, position " << errors.position_m << " m, step " << errors.step_m
            << " m\n";
  return errors;
}

Errors errorsOf(const JointParams& params, const PointDrive::Options& options = kStreet,
                const WindowParams& window = {}) {
  return errorsOf([&] { return std::make_unique<JointBackend>(params, kPointRig, window); }, options);
}

TEST(JointBackend, IsBetterThanBothBaselines) {
  const Errors joint = errorsOf(JointParams{});
  const Errors graph =
      errorsOf([] { return std::make_unique<PoseGraphBackend>(PoseGraphBackend::Params{}, kPointRig); }, kStreet);
  const Errors filter =
      errorsOf([] { return std::make_unique<FilterBackend>(FilterBackend::Params{}, kPointRig); }, kStreet);
  EXPECT_LT(joint.camera_m, 0.5 * graph.camera_m);
  EXPECT_LT(joint.position_m, 0.65 * filter.position_m);
  EXPECT_LT(joint.position_m, graph.position_m);
  EXPECT_LT(joint.step_m, filter.step_m);
}

TEST(JointBackend, KnowledgeOfHowVehiclesMoveHelps) {
  const Errors rough = errorsOf(JointParams{}, kStreet, {.use_smoothness = false});
  EXPECT_LT(errorsOf(JointParams{}).step_m, 0.8 * rough.step_m);
}

TEST(JointBackend, LongerTracksHelp) {
  JointParams brief;
  brief.track_frames = 3;
  EXPECT_LT(errorsOf(JointParams{}).camera_m, 0.9 * errorsOf(brief).camera_m);
}

/// A vehicle's points are known as such after some frames. Their views before are not lost.
TEST(JointBackend, ViewsOfPointsThatWereUndecidedHelp) {
  PointDrive::Options brief = kStreet;
  brief.points = 12;
  brief.life_frames = 6;
  brief.undecided_frames = 3;
  PointDrive::Options silent = brief;
  silent.tells_undecided = false;
  const Errors with = errorsOf(JointParams{}, brief), without = errorsOf(JointParams{}, silent);
  EXPECT_LT(with.position_m, 0.8 * without.position_m);
  EXPECT_LT(with.step_m, 0.8 * without.step_m);
}

/// Rotation of the objects' published motion in the first frames after each appeared, RMS [rad].
double earlyRotationError_rad(const JointParams& params) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    PointDrive::Options options = kStreet;
    options.points = 10;
    PointDrive drive(seed, options);
    JointBackend backend(params, kPointRig);
    const auto online = test::runDrive(backend, drive).online;
    for (std::size_t k = 1; k < 5; ++k)
      for (std::size_t i = 0; i < std::min(online[k].objects.size(), online[k - 1].objects.size()); ++i) {
        const std::size_t vehicle = online[k].objects[i].track.value - 100;
        const int frame = static_cast<int>(k);
        const SE3 truth = drive.truth().object(vehicle, frame - 1).inverse() * drive.truth().object(vehicle, frame);
        const SE3 step = online[k - 1].objects[i].T_world_body.inverse() * online[k].objects[i].T_world_body;
        sum += (truth.inverse() * step).log().tail<3>().squaredNorm();
        ++count;
      }
  }
  return std::sqrt(sum / count);
}

TEST(JointBackend, VehiclesHardlyTurnWhenTheyAreFirstSeen) {
  JointParams tumbling;
  tumbling.yaw_rate_sigma_radps = tumbling.tilt_rate_sigma_radps = 1;
  const double vehicle_rad = earlyRotationError_rad(JointParams{}), tumbling_rad = earlyRotationError_rad(tumbling);
  std::cout << vehicle_rad << " rad, tumbling " << tumbling_rad << " rad\n";
  EXPECT_LT(vehicle_rad, 0.8 * tumbling_rad);
}

TEST(JointBackend, WithoutPointsTheCameraFollowsTheOdometry) {
  PointDrive drive(1, {.points = 0, .drive = {.odometry_sigma_m = 0.01, .odometry_sigma_rad = 0.0005}});
  JointBackend backend(JointParams{}, kPointRig);
  const auto finals = test::runDrive(backend, drive).finals;
  ASSERT_EQ(finals.size(), 60U);
  EXPECT_LT(cameraError_m(finals, drive.truth()), 1.0);
}

/// Error of the camera's published motion from frame to frame, RMS over seeds [m].
double onlineCameraStepError_m(const JointParams& params) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    PointDrive drive(seed, kStreet);
    JointBackend backend(params, kPointRig);
    const auto online = test::runDrive(backend, drive).online;
    for (int i = 1; i < static_cast<int>(online.size()); ++i) {
      const SE3 truth = drive.truth().camera(i - 1).inverse() * drive.truth().camera(i);
      const SE3 step = online[i - 1].T_world_cam.inverse() * online[i].T_world_cam;
      sum += (truth.inverse() * step).translation().squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

/// Landmarks at rest that are eliminated in every other frame: the camera is aligned to them in between.
TEST(JointBackend, AlignmentToKnownLandmarksIsAsExactAsTheirElimination) {
  JointParams in_each_frame, seldom;
  in_each_frame.frames_per_elimination = 1;
  seldom.frames_per_elimination = 12;
  EXPECT_LT(errorsOf(JointParams{}).camera_m, 1.1 * errorsOf(in_each_frame).camera_m);
  const double each_m = onlineCameraStepError_m(in_each_frame), every_other_m = onlineCameraStepError_m(JointParams{}),
               seldom_m = onlineCameraStepError_m(seldom);
  std::cout << "online steps " << each_m << " m, " << every_other_m << " m, " << seldom_m << " m\n";
  EXPECT_LT(every_other_m, 1.1 * each_m);
  EXPECT_LT(every_other_m, 0.5 * kStreet.drive.odometry_sigma_m);  // what there would be without alignment
  EXPECT_GT(seldom_m, every_other_m);                              // new landmarks are known too late
}

/// A vehicle that was first seen askew: the direction of its travel is learned, and its poses follow.
TEST(JointBackend, AxesComeToLieAlongTheTravel) {
  constexpr double kAskew_rad = 0.15;
  PointDrive drive(5, kStreet);
  JointBackend backend(JointParams{}, kPointRig);
  const SE3 askew(expSO3({0, 0, kAskew_rad}), Eigen::Vector3d::Zero());
  for (int i = 0; i < drive.options().frames; ++i) {
    FrameMeasurements measured = *drive.measure(i);
    for (ObjectObservation& seen : measured.objects) seen.T_cam_body = seen.T_cam_body * askew;
    backend(std::make_shared<const FrameMeasurements>(std::move(measured)));
  }
  double squared = 0;
  int count = 0;
  for (const FrameEstimate& frame : backend.finish())
    for (const ObjectEstimate& object : frame.objects) {
      const SE3 truth = drive.truth().object(object.track.value - 100, static_cast<int>(frame.head.frame.value));
      squared += logSO3(truth.rotation().transpose() * object.T_world_body.rotation()).squaredNorm();
      ++count;
    }
  EXPECT_LT(std::sqrt(squared / count), 0.2 * kAskew_rad);
}

class JointBackendOffset : public testing::TestWithParam<double> {};

TEST_P(JointBackendOffset, ComesOut) {
  PointDrive::Options options = kStreet;
  options.offset_px = GetParam();
  PointDrive drive(3, options);
  JointBackend backend(JointParams{}, kPointRig);
  double offset_px = 0;
  for (int frame = 0; frame < 50; ++frame) offset_px = backend(drive.measure(frame))->counters.disparity_offset_px;
  EXPECT_NEAR(offset_px, GetParam(), GetParam() == 0 ? 0.02 : 0.1);
}

INSTANTIATE_TEST_SUITE_P(Rigs, JointBackendOffset, testing::Values(0.0, 1.2, -0.6));

/// The problems of a drive with an offset, whose calibration is said to be exact to `sigma_px`.
std::vector<std::string> toldOf(double offset_px, double sigma_px) {
  PointDrive::Options options = kStreet;
  options.offset_px = offset_px;
  PointDrive drive(3, options);
  WindowParams window;
  window.calibration.disparity_px = sigma_px;
  JointBackend backend(JointParams{}, kPointRig, window);
  std::vector<std::string> told;
  for (int frame = 0; frame < 50; ++frame) {
    const auto problems = backend(drive.measure(frame))->problems;
    told.insert(told.end(), problems.begin(), problems.end());
  }
  return told;
}

TEST(JointBackend, TellsOnceOfAnOffsetThatTheCalibrationMakesUnlikely) {
  EXPECT_THAT(toldOf(1.2, 0.15), testing::ElementsAre(testing::HasSubstr("disparities are too small by about ")));
  EXPECT_THAT(toldOf(-1.2, 0.15), testing::ElementsAre(testing::HasSubstr("disparities are too large by about ")));
  EXPECT_THAT(toldOf(1.2, 1), testing::IsEmpty());
  EXPECT_THAT(toldOf(0, 0.15), testing::IsEmpty());
}

TEST(JointBackend, TrustsARigWhenToldTo) {
  PointDrive::Options options = kStreet;
  options.offset_px = 1.2;
  JointParams trusting;
  trusting.offset_sigma_px = 0;
  EXPECT_LT(errorsOf(JointParams{}, options).camera_m, 0.5 * errorsOf(trusting, options).camera_m);
}

double shakeFound_px(double shake_px, const JointParams& params = {}) {
  PointDrive::Options options = kStreet;
  options.shake_px = shake_px;
  PointDrive drive(3, options);
  JointBackend backend(params, kPointRig);
  return test::runDrive(backend, drive).counters.disparity_shake_px;
}

TEST(JointBackend, FindsHowTheCamerasShake) {
  EXPECT_LT(shakeFound_px(0), 0.015);
  EXPECT_NEAR(shakeFound_px(0.1), 0.1, 0.02);
  JointParams rigid;
  rigid.shake_sigma_px = 0;
  EXPECT_EQ(shakeFound_px(0.1, rigid), 0);
}

/// Far objects are harmed most: their points are few.
TEST(JointBackend, AShakeThatIsFoundHarmsObjectsLess) {
  PointDrive::Options shaking = kStreet;
  shaking.shake_px = 0.2;
  JointParams rigid;
  rigid.shake_sigma_px = 0;
  const Errors with = errorsOf(JointParams{}, shaking), without = errorsOf(rigid, shaking);
  EXPECT_LT(with.position_m, 0.95 * without.position_m);
  EXPECT_LT(with.step_m, 0.85 * without.step_m);
}

/// Final estimates are as good as a batch solution over the whole drive.
TEST(JointBackend, FinalsOfAShortWindowAreThoseOfABatchSolution) {
  PointDrive once(4, kStreet), again(4, kStreet);
  JointParams sliding, batch;
  sliding.final_iterations = 0;
  batch.final_iterations = 20;
  JointBackend one(sliding, kPointRig, {.window_frames = 30}), other(batch, kPointRig, {.window_frames = 0});
  const auto finals = test::runDrive(one, once).finals, best = test::runDrive(other, again).finals;
  ASSERT_EQ(finals.size(), best.size());
  for (std::size_t i = 1; i < finals.size(); ++i) {
    const SE3 step = finals[i - 1].T_world_cam.inverse() * finals[i].T_world_cam;
    const SE3 best_step = best[i - 1].T_world_cam.inverse() * best[i].T_world_cam;
    EXPECT_LT((step.translation() - best_step.translation()).norm(), 0.002) << i;
  }
  EXPECT_NEAR(test::objectError_m(finals, once.truth()), test::objectError_m(best, again.truth()), 0.02);
}

/// Points are followed for three times as long as the window lasts.
TEST(JointBackend, AWindowShorterThanItsTracksLosesLittle) {
  const auto run = [](int window_frames) {
    PointDrive drive(4, kStreet);
    JointBackend backend(JointParams{}, kPointRig, {.window_frames = window_frames});
    std::vector<FrameEstimate> finals;
    for (int i = 0; i < drive.options().frames; ++i) {
      const auto estimates = backend(drive.measure(i));
      EXPECT_TRUE(estimates->problems.empty()) << "frame " << i << ": " << estimates->problems.front();
      finals.insert(finals.end(), estimates->finals.begin(), estimates->finals.end());
    }
    const auto rest = backend.finish();
    finals.insert(finals.end(), rest.begin(), rest.end());
    return std::pair(cameraError_m(finals, drive.truth()), test::stepError_m(finals, drive.truth()));
  };
  const auto [camera_m, step_m] = run(5);
  const auto [best_camera_m, best_step_m] = run(0);
  std::cout << "camera " << camera_m << " instead of " << best_camera_m << " m, steps of objects " << step_m
            << " instead of " << best_step_m << " m\n";
  EXPECT_LT(camera_m, 1.5 * best_camera_m);
  EXPECT_LT(step_m, 2.5 * best_step_m);
}

/// Objects that nobody tells of any more, neither that they are seen nor that they ended.
TEST(JointBackend, ObjectsThatAreGoneLeaveTheWindow) {
  constexpr int kSeen = 25;
  PointDrive drive(2, kStreet);
  ASSERT_GT(drive.options().frames, 2 * kSeen);
  JointBackend backend(JointParams{}, kPointRig, {.window_frames = kSeen});
  std::size_t seen = 0, published = 0;
  for (int i = 0; i < drive.options().frames; ++i) {
    FrameMeasurements measured = *drive.measure(i);
    if (i >= kSeen) measured.objects.clear();
    seen += measured.objects.size();
    const auto estimates = backend(std::make_shared<const FrameMeasurements>(std::move(measured)));
    EXPECT_TRUE(estimates->problems.empty()) << "frame " << i << ": " << estimates->problems.front();
    for (const FrameEstimate& frame : estimates->finals) published += frame.objects.size();
  }
  for (const FrameEstimate& frame : backend.finish()) EXPECT_TRUE(frame.objects.empty());
  EXPECT_EQ(published, seen);
}

}  // namespace
}  // namespace motorcade
