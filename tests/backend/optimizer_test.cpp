#include "backend/optimizer.hpp"

#include <gtest/gtest.h>

#include "backend/make_backend.hpp"
#include "tests/backend/simulated_drive.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::DriveResult;
using test::SimulatedDrive;

DriveResult smooth(std::uint64_t seed, const Optimizer::Params& params = {}, const SimulatedDrive::Options& options = {}) {
  SimulatedDrive drive(seed, options);
  Optimizer optimizer(params);
  return runDrive(optimizer, drive);
}

double error_m(const std::vector<FrameEstimate>& estimates) { return objectError_m(estimates, SimulatedDrive(0, {})); }

TEST(Optimizer, ObjectsAreBetterThanRawAndThanTheFilter) {
  double raw = 0, filtered = 0, smoothed = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    smoothed += error_m(smooth(seed).finals);
    SimulatedDrive drive(seed, {});
    FilterBackend filter({});
    filtered += error_m(runDrive(filter, drive).finals);
    // Raw: what the front-end saw, put at the chained camera.
    SimulatedDrive again(seed, {});
    SE3 T_world_cam;
    std::vector<FrameEstimate> seen;
    for (int i = 0; i < again.options().frames; ++i) {
      const auto m = again.measure(i);
      T_world_cam = T_world_cam * m->T_previous_now;
      seen.push_back({.frame = m->frame, .stamp = {}, .T_world_cam = T_world_cam, .camera_covariance = {}, .objects = {}});
      for (const auto& o : m->objects) seen.back().objects.push_back({.track = o.track, .T_world_body = T_world_cam * o.T_cam_body, .box = {}, .covariance = {}});
    }
    raw += error_m(seen);
  }
  std::cout << "mean position error of objects: raw " << raw / 10 << " m, filter " << filtered / 10 << " m, smoother " << smoothed / 10 << " m\n";
  EXPECT_LT(smoothed, 0.8 * raw);
  EXPECT_LT(smoothed, filtered);
}

TEST(Optimizer, EveryFrameBecomesFinalOnceAndInOrder) {
  for (const int window : {0, 1, 7, 1000}) {
    const auto result = smooth(3, {.window_frames = window});
    ASSERT_EQ(result.finals.size(), 60u);
    for (std::size_t i = 0; i < result.finals.size(); ++i) {
      EXPECT_EQ(result.finals[i].frame.value, static_cast<std::int64_t>(i));
      EXPECT_TRUE(result.finals[i].T_world_cam.translation().allFinite());
    }
  }
}

}  // namespace
}  // namespace motorcade
