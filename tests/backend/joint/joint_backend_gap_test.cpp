#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "backend/joint/joint_backend.hpp"
#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::kStreet;
using test::PointDrive;

/// Error of the objects' motion over five frames without images, RMS over seeds [m]. Afterwards their points are seen
/// again, or `renewed` by others.
double errorOverDarkFrames_m(bool renewed) {
  constexpr int kLastBefore = 20, kFirstAfter = 26;
  PointDrive::Options lasting = kStreet;
  lasting.life_frames = 1000;
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    PointDrive drive(seed, lasting);
    JointBackend backend(JointParams{}, kPointRig);
    std::vector<FrameEstimate> finals;
    for (int i = 0; i < drive.options().frames; ++i) {
      FrameMeasurements m = *drive.measure(i);
      const bool dark = i > kLastBefore && i < kFirstAfter;
      if (dark) m.head.status = FrameStatus::kLost, m.at_rest.clear();
      for (ObjectObservation& seen : m.objects) {
        if (dark) seen.state = ObjectState::kPredicted, seen.measured.clear();
        if (renewed && i >= kFirstAfter)
          for (PointMeasurement& p : seen.measured) p.point.value += 1'000'000'000;
      }
      std::ranges::move(backend(std::make_shared<const FrameMeasurements>(m))->finals, std::back_inserter(finals));
    }
    std::ranges::move(backend.finish(), std::back_inserter(finals));
    for (const ObjectEstimate& before : finals[kLastBefore].objects) {
      const auto after = std::ranges::find(finals[kFirstAfter].objects, before.track, &ObjectEstimate::track);
      if (after == finals[kFirstAfter].objects.end()) continue;
      const auto vehicle = static_cast<std::size_t>(before.track.value - 100);
      const SE3 truth =
          drive.truth().object(vehicle, kLastBefore).inverse() * drive.truth().object(vehicle, kFirstAfter);
      const SE3 motion = before.T_world_body.inverse() * after->T_world_body;
      sum += (truth.translation() - motion.translation()).squaredNorm();
      ++count;
    }
  }
  EXPECT_GT(count, 0);
  return std::sqrt(sum / count);
}

TEST(JointBackend, LandmarksOfObjectsLastOverFramesWithoutImages) {
  const double kept_m = errorOverDarkFrames_m(false), renewed_m = errorOverDarkFrames_m(true);
  std::cout << kept_m << " m, with other points afterwards " << renewed_m << " m\n";
  EXPECT_LT(kept_m, 0.7 * renewed_m);
}

/// The frames before the gap leave the window while it is dark, and what linked the later ones to them stays.
TEST(JointBackend, DarkFramesThatFillAShortWindowLoseNothing) {
  constexpr int kWindow_frames = 8, kDark = 20, kLight = 30;
  PointDrive drive(3, kStreet);
  JointBackend backend(JointParams{}, kPointRig, {.window_frames = kWindow_frames});
  for (int i = 0; i < drive.options().frames; ++i) {
    FrameMeasurements m = *drive.measure(i);
    if (i >= kDark && i < kLight) {
      m.head.status = FrameStatus::kLost;
      m.at_rest.clear(), m.undecided.clear(), m.objects.clear();
    }
    const auto estimates = backend(std::make_shared<const FrameMeasurements>(std::move(m)));
    EXPECT_TRUE(estimates->problems.empty()) << "frame " << i << ": " << estimates->problems.front();
  }
}

}  // namespace
}  // namespace motorcade
