#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/filter/map_filter_backend.hpp"
#include "backend/pose_graph/pose_graph_backend.hpp"
#include "tests/backend/simulated_drive.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::DriveResult;
using test::SimulatedDrive;

DriveResult smooth(std::uint64_t seed, const WindowParams& window = {}, const SimulatedDrive::Options& options = {},
                   const PoseGraphParams& params = {}) {
  SimulatedDrive drive(seed, options);
  PoseGraphSmoother smoother(params, window);
  return runDrive(smoother, drive);
}

double error_m(const std::vector<FrameEstimate>& estimates) { return objectError_m(estimates, SimulatedDrive(0, {})); }

TEST(PoseGraphSmoother, ObjectsAreBetterThanRawAndThanTheFilter) {
  double raw = 0, filtered = 0, smoothed = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    smoothed += error_m(smooth(seed).finals);
    SimulatedDrive drive(seed, {});
    MapFilterBackend filter({});
    filtered += error_m(runDrive(filter, drive).finals);
    // Raw: what the front-end measured, from the camera of chained odometry.
    SimulatedDrive again(seed, {});
    SE3 T_world_cam;
    std::vector<FrameEstimate> seen;
    for (int i = 0; i < again.options().frames; ++i) {
      const auto m = again.measure(i);
      T_world_cam = T_world_cam * m->odometry.T_previous_now;
      seen.push_back({.head = m->head, .T_world_cam = T_world_cam, .camera_covariances = {}, .objects = {}});
      for (const auto& o : m->objects)
        seen.back().objects.push_back(
            {.track = o.track, .T_world_body = T_world_cam * o.T_cam_body, .box = {}, .covariance = {}});
    }
    raw += error_m(seen);
  }
  std::cout << "mean position error of objects: raw " << raw / 10 << " m, filter " << filtered / 10 << " m, smoother "
            << smoothed / 10 << " m\n";
  EXPECT_LT(smoothed, 0.8 * raw);
  EXPECT_LT(smoothed, filtered);
}

TEST(PoseGraphSmoother, EveryFrameBecomesFinalOnceAndInOrder) {
  for (const int window : {0, 1, 7, 1000}) {
    const auto result = smooth(3, {.window_frames = window});
    ASSERT_EQ(result.finals.size(), 60u);
    for (std::size_t i = 0; i < result.finals.size(); ++i) {
      EXPECT_EQ(result.finals[i].head.frame.value, static_cast<std::int64_t>(i));
      EXPECT_TRUE(result.finals[i].T_world_cam.translation().allFinite());
    }
  }
}

/// Normalized error squared per dimension of the objects' poses seen from the camera, every fifth frame.
double objectNees(const std::vector<FrameEstimate>& estimates, const SimulatedDrive& drive) {
  double sum = 0;
  int count = 0;
  for (const auto& frame : estimates) {
    const int i = static_cast<int>(frame.head.frame.value);
    if (i % 5 != 0) continue;
    for (const auto& object : frame.objects) {
      if (!object.covariance) continue;
      const SE3 truth = drive.camera(i).inverse() * drive.object(object.track.value - 100, i);
      const Vector6d error = (truth.inverse() * frame.T_world_cam.inverse() * object.T_world_body).log();
      sum += error.dot(object.covariance->llt().solve(error)) / 6;
      ++count;
    }
  }
  return sum / count;
}

/// The same of the camera's motion over ten frames.
double cameraNees(const std::vector<FrameEstimate>& estimates, const SimulatedDrive& drive) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 10; i < estimates.size(); i += 5) {
    if (!estimates[i].camera_covariances.motion) continue;
    const int n = static_cast<int>(i);
    const SE3 truth = drive.camera(n - 10).inverse() * drive.camera(n);
    const Vector6d error = (truth.inverse() * estimates[i - 10].T_world_cam.inverse() * estimates[i].T_world_cam).log();
    sum += error.dot(estimates[i].camera_covariances.motion->llt().solve(error)) / 6;
    ++count;
  }
  return sum / count;
}

TEST(PoseGraphSmoother, CovariancesAreHonest) {
  // Only vehicles on random drives would follow the motion model; at constant twist errors are a little below the
  // covariance.
  double object = 0, camera = 0, without_objects = 0;
  constexpr int kSeeds = 30;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto finals = smooth(seed).finals;
    object += objectNees(finals, SimulatedDrive(0, {})) / kSeeds;
    camera += cameraNees(finals, SimulatedDrive(0, {})) / kSeeds;
    SimulatedDrive::Options empty;
    empty.vehicles.clear();
    without_objects += cameraNees(smooth(seed, {}, empty).finals, SimulatedDrive(0, {})) / kSeeds;
  }
  std::cout << "NEES per dimension: objects " << object << ", camera " << camera << ", camera without objects "
            << without_objects << "\n";
  EXPECT_GT(object, 0.6);
  EXPECT_LT(object, 1.15);
  EXPECT_GT(camera, 0.8);
  EXPECT_LT(camera, 1.15);
}

TEST(PoseGraphSmoother, PublishedObjectsDoNotMoveByTheirCorrections) {
  const SimulatedDrive drive(0, {});
  double steps = 0, steps_as_estimated = 0, poses = 0, poses_as_estimated = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto continuous = smooth(seed), plain = smooth(seed, {.online_correction_s = 0});
    steps += stepError_m(continuous.online, drive);
    steps_as_estimated += stepError_m(plain.online, drive);
    poses += error_m(continuous.online);
    poses_as_estimated += error_m(plain.online);
    EXPECT_EQ(error_m(continuous.finals), error_m(plain.finals));
  }
  std::cout << "online steps " << steps / 10 << " m, as estimated " << steps_as_estimated / 10 << " m; poses "
            << poses / 10 << " and " << poses_as_estimated / 10 << " m\n";
  EXPECT_LT(steps, 0.8 * steps_as_estimated);
  EXPECT_LT(poses, 1.2 * poses_as_estimated);
}

TEST(PoseGraphSmoother, EachKindOfFactorMakesItBetter) {
  const auto meanStepError_m = [](const PoseGraphParams& params, const WindowParams& window = {}) {
    constexpr int kSeeds = 10;
    double sum = 0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
      sum += stepError_m(smooth(seed, window, {}, params).finals, SimulatedDrive(0, {})) / kSeeds;
    return sum;
  };
  const double all = meanStepError_m({}), without_motion = meanStepError_m({.use_motion = false}),
               without_smoothness = meanStepError_m({}, {.use_smoothness = false}),
               without_encounters = meanStepError_m({.use_camera_encounter = false});
  std::cout << "step error of objects: all " << all << " m, without motion " << without_motion
            << ", without smoothness " << without_smoothness << ", without encounters " << without_encounters << "\n";
  EXPECT_LT(all, 0.99 * without_motion);
  EXPECT_LT(all, 0.8 * without_smoothness);
  EXPECT_LT(all, 0.99 * without_encounters);
  // An encounter of two objects divides what was measured anew; it adds nothing to it, and must take nothing away.
  EXPECT_NEAR(all, meanStepError_m({.use_object_encounter = false}), 0.05 * all);
}

TEST(PoseGraphSmoother, AnyCombinationOfFactorsCanBeSolved) {
  const auto isFiniteWith = [](const PoseGraphParams& params, bool use_smoothness) {
    for (const auto& frame : smooth(2, {.use_smoothness = use_smoothness}, {}, params).finals)
      for (const auto& object : frame.objects)
        if (!isFinite(object.T_world_body)) return false;
    return true;
  };
  EXPECT_TRUE(isFiniteWith({.use_motion = false, .use_camera_encounter = false}, false));
  EXPECT_TRUE(isFiniteWith({.use_motion = false}, false));
  EXPECT_TRUE(isFiniteWith({.use_camera_encounter = false}, false));
}

TEST(PoseGraphSmoother, ALateConfirmationFillsInTheFramesBefore) {
  SimulatedDrive::Options late;
  late.confirmed_after = 4;
  const auto result = smooth(5, {}, late);
  EXPECT_TRUE(result.online[3].objects.empty());
  EXPECT_EQ(result.online[4].objects.size(), 2u);
  EXPECT_EQ(result.finals[0].objects.size(), 2u);
  EXPECT_EQ(result.finals[5].objects.size(), 3u);
  // With all the measurements in, it does not matter when they came.
  const auto early = smooth(5);
  EXPECT_NEAR(error_m(result.finals), error_m(early.finals), 0.02);
}

TEST(PoseGraphSmoother, VariablesStayBoundedWhenObjectsComeAndGo) {
  SimulatedDrive::Options options;
  options.frames = 200;
  options.vehicles.clear();
  for (int i = 0; i < 20; ++i) options.vehicles.push_back({{2, 1, 8.0 * i + 10}, 0, 8, 0, 10 * i, 10 * i + 14});
  const auto result = smooth(1, {.window_frames = 30}, options);
  EXPECT_LE(result.counters.variables, 30 + 2 * 30 + 5);
  EXPECT_GE(result.counters.retired_variables, 170 + 250);
  ASSERT_EQ(result.finals.size(), 200u);
  for (int i = 30; i < 185; ++i) EXPECT_FALSE(result.finals[i].objects.empty());
}

TEST(PoseGraphSmoother, SpeedAndItsSigmaMatchTheVehicles) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto finals = smooth(seed).finals;
    for (std::size_t i = 10; i < 40; ++i)
      for (const auto& object : finals[i].objects) {
        const double truth_mps = SimulatedDrive::Options{}.vehicles[object.track.value - 100].speed_mps;
        sum += std::pow((object.velocity_world_mps.norm() - truth_mps) / object.speed_sigma_mps, 2);
        EXPECT_NEAR(object.velocity_world_mps.norm(), truth_mps, 2.0);
        ++count;
      }
  }
  EXPECT_GT(sum / count, 0.1);
  EXPECT_LT(sum / count, 1.3);
}

TEST(PoseGraphSmoother, LostFramesKeepTheirPredictedPose) {
  SimulatedDrive drive(7, {});
  PoseGraphSmoother smoother({});
  for (int i = 0; i < 30; ++i) {
    FrameMeasurements m = *drive.measure(i);
    if (i == 15) {
      m.head.status = FrameStatus::kLost;
      m.odometry.covariance = SimulatedDrive::covariance(0.5, 0.05);
      m.objects.clear();
    }
    smoother(std::make_shared<const FrameMeasurements>(m));
  }
  const auto finals = smoother.finish();
  ASSERT_EQ(finals.size(), 30u);
  EXPECT_EQ(finals[15].head.status, FrameStatus::kLost);
  EXPECT_THAT(finals[16].T_world_cam, test::IsNearPose(drive.camera(16), 0.5));
}

TEST(PoseGraphSmoother, ABrokenObjectDoesNotStopTheCamera) {
  SimulatedDrive drive(8, {});
  PoseGraphSmoother smoother({});
  for (int i = 0; i < 30; ++i) {
    FrameMeasurements m = *drive.measure(i);
    for (auto& seen : m.objects) {
      if (i == 5) seen.T_cam_body = SE3(Eigen::Matrix3d::Identity(), {std::nan(""), 0, 0});
      if (i == 6) seen.encounter_covariance.setZero();
      if (i == 7 && seen.motion) seen.motion->covariance.setConstant(std::nan(""));
      if (i == 8 && seen.motion) seen.motion->T_before_now = SE3(Eigen::Matrix3d::Identity(), {std::nan(""), 0, 0});
    }
    if (i == 9) m.odometry.T_previous_now = SE3(Eigen::Matrix3d::Identity(), {std::nan(""), 0, 0});
    const auto estimates = smoother(std::make_shared<const FrameMeasurements>(m));
    EXPECT_TRUE(estimates->online.T_world_cam.translation().allFinite());
    for (const auto& object : estimates->online.objects) EXPECT_TRUE(object.T_world_body.translation().allFinite());
  }
  EXPECT_EQ(smoother.finish().size(), 30u);
}

TEST(PoseGraphSmoother, NamesAParameterOutOfRange) {
  try {
    PoseGraphSmoother smoother({}, {.online_correction_s = -1});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("online_correction_s"));
  }
}

}  // namespace
}  // namespace motorcade
