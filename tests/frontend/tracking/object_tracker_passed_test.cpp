#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "frontend/tracking/object_tracker.hpp"
#include "tests/support/simulated_traffic.hpp"
#include "tests/support/stereo_views.hpp"

/// Objects that leave the view, and what follows them.
namespace motorcade {
namespace {

using test::kRig;
using test::SimulatedCar;
using test::SimulatedTraffic;

struct Track {
  std::vector<ObjectObservation> observations;
  int ends = 0;
};

std::map<TrackId, Track> tracksOf(SimulatedTraffic& traffic, int frames, const ObjectTracker::Params& params = {}) {
  ObjectTracker tracker(params, kRig);
  std::map<TrackId, Track> tracks;
  for (int frame = 0; frame < frames; ++frame) {
    const FrameMeasurementsPtr measurements = tracker(traffic.next());
    for (const ObjectObservation& o : measurements->objects) tracks[o.track].observations.push_back(o);
    for (const TrackId track : measurements->ended) ++tracks[track].ends;
  }
  return tracks;
}

/// The trailer comes into view when the truck is known, and its points join it.
TEST(ObjectTracker, ATrailerIsAnObjectOfItsOwnOnceItsTruckHasPassed) {
  constexpr double kHalf_m = 3.3;  // of the trailer's length
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const SimulatedCar truck{.x_m = -2, .z_m = 11, .heading_rad = M_PI / 2, .speed_mps = 7, .points = 150, .size = 1.5};
    SimulatedCar trailer = truck;
    trailer.x_m -= 7;
    trailer.gone_from = 0, trailer.gone_until = 8;
    SimulatedTraffic traffic({truck, trailer}, 0, seed);
    const auto tracks = tracksOf(traffic, 29);
    ASSERT_EQ(tracks.size(), 2U) << "seed " << seed;
    EXPECT_EQ(tracks.begin()->second.ends, 1) << "seed " << seed;
    const auto &of_truck = tracks.begin()->second.observations, &of_trailer = tracks.rbegin()->second.observations;
    EXPECT_LE(of_trailer.front().frame.value, of_truck.back().frame.value + 1) << "seed " << seed;
    EXPECT_EQ(of_trailer.back().frame.value, 28) << "seed " << seed;
    for (const ObjectObservation& o : of_trailer) {
      const SE3 T_cam_trailer = traffic.carInCamera(1, static_cast<int>(o.frame.value));
      EXPECT_LT(std::abs(o.T_cam_body.translation().x() - T_cam_trailer.translation().x()), kHalf_m) << "seed " << seed;
    }
  }
}

TEST(ObjectTracker, ACarKeepsItsIdUntilItHasLeftTheView) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    SimulatedTraffic traffic({{.x_m = -2, .z_m = 11, .heading_rad = M_PI / 2, .speed_mps = 7, .points = 150}}, 0, seed);
    EXPECT_EQ(tracksOf(traffic, 29).size(), 1U) << "seed " << seed;
  }
}

/// A car comes back about when the object that it was ends. Scene flow takes the same time whenever that is.
TEST(ObjectTracker, AnObjectThatEndsClaimsNoComponent) {
  ObjectTracker::Params params;
  params.look_back_frames = 0;
  for (const int back : {30, 31, 32, 33, 34, 35, 36, 37, 38}) {
    SimulatedTraffic traffic({{.x_m = 0.5, .z_m = 15, .speed_mps = 10, .gone_from = 20, .gone_until = back}}, 10, 1);
    const auto tracks = tracksOf(traffic, 50, params);
    if (tracks.size() < 2) continue;
    EXPECT_EQ(tracks.rbegin()->second.observations.front().frame.value, back + 2) << "back in frame " << back;
  }
}

}  // namespace
}  // namespace motorcade
