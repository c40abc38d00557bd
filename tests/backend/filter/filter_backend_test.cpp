#include "backend/filter/filter_backend.hpp"

#include <gtest/gtest.h>

#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::PointDrive;

const PointDrive::Options kSureOdometry{.drive = {.odometry_sigma_m = 0.005, .odometry_sigma_rad = 0.0002}};

TEST(FilterBackend, ChainsTheMotionsOfThePoints) {
  PointDrive drive(1, kSureOdometry);
  FilterBackend filter({}, kPointRig);
  const auto finals = runDrive(filter, drive).finals;
  ASSERT_EQ(finals.size(), 60U);
  EXPECT_LT(test::stepError_m(finals, drive.truth()), 0.1);  // vehicles go 0.6 to 0.9 m in a frame
  EXPECT_LT(test::objectError_m(finals, drive.truth()), 1.0);
}

TEST(FilterBackend, WithLongerTracksTheChainDriftsNoLess) {
  // Only two frames at a time count: how long a point is followed does not matter but for the points that are replaced.
  PointDrive::Options lasting = kSureOdometry;
  lasting.life_frames = 1000;
  double replaced_m = 0, lasting_m = 0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    PointDrive drive(seed, kSureOdometry), lasting_drive(seed, lasting);
    FilterBackend filter({}, kPointRig), lasting_filter({}, kPointRig);
    replaced_m += test::stepError_m(runDrive(filter, drive).finals, drive.truth());
    lasting_m += test::stepError_m(runDrive(lasting_filter, lasting_drive).finals, drive.truth());
  }
  EXPECT_NEAR(lasting_m, replaced_m, 0.6 * replaced_m);
}

TEST(FilterBackend, GoesOnWhereTheObjectIsExpectedAfterFramesWithoutPoints) {
  PointDrive drive(2, kSureOdometry);
  FilterBackend filter({}, kPointRig);
  for (int frame = 0; frame < 30; ++frame) {
    FrameMeasurements m = *drive.measure(frame);
    for (ObjectObservation& seen : m.objects)
      if (frame >= 15 && frame < 18) seen.state = ObjectState::kPredicted, seen.measured.clear();
    const auto estimates = filter(std::make_shared<const FrameMeasurements>(m));
    if (frame < 10) continue;
    for (const ObjectEstimate& object : estimates->online.objects) {
      const SE3 truth = drive.truth().object(static_cast<std::size_t>(object.track.value - 100), frame);
      EXPECT_LT((object.T_world_body.translation() - truth.translation()).norm(), 2.0) << frame;
    }
  }
}

}  // namespace
}  // namespace motorcade
