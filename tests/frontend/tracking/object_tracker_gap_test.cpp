#include <cstddef>
#include <memory>
#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "frontend/tracking/object_tracker.hpp"
#include "tests/support/simulated_traffic.hpp"
#include "tests/support/stereo_views.hpp"

/// Objects where images do not tell how the camera moved.
namespace motorcade {
namespace {

/// The number of objects that a lead car becomes where images do not tell the camera's motion in one frame.
std::size_t objectsAcrossAnUnlinkedFrame(const std::optional<Odometry::Told>& told) {
  test::SimulatedTraffic traffic({{.x_m = 0.5, .z_m = 14, .speed_mps = 10}}, 10, 1, 0.003);
  ObjectTracker tracker({}, test::kRig);
  std::set<TrackId> ids;
  for (int frame = 0; frame < 40; ++frame) {
    SceneMotion scene = *traffic.next();
    if (frame == 20) {
      scene.head.status = FrameStatus::kLost;
      scene.head.cause = FrameCause::kUnlinked;
      scene.odometry.told = told;
    }
    const auto measurements = tracker(std::make_shared<const SceneMotion>(scene));
    for (const auto& object : measurements->objects) ids.insert(object.track);
  }
  return ids.size();
}

TEST(ObjectTrackerInAGap, ObjectsEndWhereNobodyKnowsTheCamerasMotionAndGoOnWhereSensorsTellIt) {
  EXPECT_EQ(objectsAcrossAnUnlinkedFrame(std::nullopt), 2U);
  EXPECT_EQ(objectsAcrossAnUnlinkedFrame(Odometry::Told{SE3{}, Matrix6d::Identity()}), 1U);
}

}  // namespace
}  // namespace motorcade
