#include "frontend/tracking/object_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/simulated_traffic.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::SimulatedCar;
using test::SimulatedTraffic;

/// Results of the tracker over a drive.
struct TrackedDrive {
  SimulatedTraffic traffic;
  ObjectTracker tracker;
  std::vector<FrameMeasurementsPtr> frames;

  TrackedDrive(const std::vector<SimulatedCar>& cars, double camera_speed_mps, int count, std::uint64_t seed = 1,
               double odometry_sigma_m = 0.003)
      : traffic(cars, camera_speed_mps, seed, odometry_sigma_m), tracker({}, kRig) {
    for (int i = 0; i < count; ++i) frames.push_back(tracker(traffic.next()));
  }
  std::set<TrackId> tracks() const {
    std::set<TrackId> ids;
    for (const auto& f : frames)
      for (const auto& o : f->objects) ids.insert(o.track);
    return ids;
  }
  /// All observations of a track in the order of delivery.
  std::vector<ObjectObservation> observations(TrackId track) const {
    std::vector<ObjectObservation> all;
    for (const auto& f : frames)
      for (const auto& o : f->objects)
        if (o.track == track) all.push_back(o);
    return all;
  }
  /// The car nearest to an observation.
  std::size_t carOf(const ObjectObservation& o, std::size_t cars) const {
    std::size_t best = 0;
    const auto distance = [&](std::size_t c) {
      return (traffic.carInCamera(c, static_cast<int>(o.frame.value)).translation() - o.T_cam_body.translation())
          .norm();
    };
    for (std::size_t c = 1; c < cars; ++c)
      if (distance(c) < distance(best)) best = c;
    return best;
  }
  /// The body's pose on the car, as the observation has it; a constant up to noise.
  SE3 bodyOnCar(const ObjectObservation& o, std::size_t car) const {
    return traffic.carInCamera(car, static_cast<int>(o.frame.value)).inverse() * o.T_cam_body;
  }
};

TEST(ObjectTracker, HandsOverEachPointOnceAndThoseOfAVehicleBeforeItIsKnown) {
  const TrackedDrive drive({{.z_m = 14, .speed_mps = 12}}, 8, 12);
  std::set<PointId> undecided, of_vehicles;
  for (const auto& f : drive.frames) {
    std::set<PointId> seen;
    const auto areNew = [&](const auto& points) {
      return std::ranges::all_of(points, [&](const PointMeasurement& p) { return seen.insert(p.point).second; });
    };
    EXPECT_TRUE(areNew(f->at_rest));
    EXPECT_TRUE(areNew(f->undecided));
    for (const auto& o : f->objects) {
      EXPECT_TRUE(o.frame != f->head.frame || areNew(o.measured));
      for (const auto& p : o.measured) of_vehicles.insert(p.point);
    }
    for (const auto& p : f->undecided) undecided.insert(p.point);
  }
  ASSERT_FALSE(of_vehicles.empty());
  EXPECT_TRUE(std::ranges::includes(undecided, of_vehicles));
}

TEST(ObjectTracker, ALeadCarKeepsOneIdForLife) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TrackedDrive drive({{.x_m = 0.5, .z_m = 14, .speed_mps = 10}}, 10, 40, seed);
    ASSERT_EQ(drive.tracks().size(), 1U) << "seed " << seed;
    const auto all = drive.observations(*drive.tracks().begin());
    EXPECT_GE(all.size(), 37U);  // scene flow needs three frames
    for (std::size_t i = 1; i < all.size(); ++i) EXPECT_EQ(all[i].frame.value, all[i - 1].frame.value + 1);
  }
}

TEST(ObjectTracker, IsConfirmedWithinFiveFramesAndBringsItsBacklogAlong) {
  const TrackedDrive drive({{.x_m = -3, .z_m = 18, .speed_mps = 8}}, 10, 12);
  const auto confirmed = std::ranges::find_if(drive.frames, [](const auto& f) { return !f->objects.empty(); });
  ASSERT_NE(confirmed, drive.frames.end());
  const auto& objects = (*confirmed)->objects;
  const std::int64_t now = (*confirmed)->head.frame.value;
  EXPECT_LE(now, 2 + 5);  // scene flow begins in frame 2
  ASSERT_GE(objects.size(), 2U);
  for (std::size_t i = 0; i < objects.size(); ++i)
    EXPECT_EQ(objects[i].frame.value,
              now - static_cast<std::int64_t>(objects.size() - 1 - i));  // oldest first, its own frame last
}

TEST(ObjectTracker, AnObjectThatVanishesIsPredictedFiveTimesAndThenEnds) {
  const TrackedDrive drive({{.x_m = 0.5, .z_m = 15, .speed_mps = 10, .gone_from = 20}}, 10, 45);
  ASSERT_EQ(drive.tracks().size(), 1U);
  const TrackId track = *drive.tracks().begin();
  int predicted = 0;
  for (const auto& o : drive.observations(track)) {
    EXPECT_EQ(o.state == ObjectState::kPredicted, o.frame.value >= 20);
    predicted += o.state == ObjectState::kPredicted;
  }
  EXPECT_EQ(predicted, 5);
  int ends = 0;
  for (const auto& f : drive.frames) {
    ends += static_cast<int>(f->ended.size());
    // It may come back while its position is known.
    EXPECT_TRUE(f->ended.empty() || f->head.frame.value > 25) << f->head.frame.value;
  }
  EXPECT_EQ(ends, 1);
}

TEST(ObjectTracker, ACarThatComesBackWithinASecondKeepsItsId) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TrackedDrive drive({{.x_m = 0.5, .z_m = 15, .speed_mps = 10, .gone_from = 20, .gone_until = 28}}, 10, 45,
                             seed);
    ASSERT_EQ(drive.tracks().size(), 1U) << "seed " << seed;
    const auto all = drive.observations(*drive.tracks().begin());
    EXPECT_EQ(all.back().frame.value, 44);
    EXPECT_EQ(all.back().state, ObjectState::kMoving);
  }
}

TEST(ObjectTracker, ACarThatComesBackIsWhereItIsSeenAgain) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    // Unseen it waits for half a second: its position was predicted three meters ahead.
    const TrackedDrive drive({{.x_m = 0.5,
                               .z_m = 18,
                               .speed_mps = 6,
                               .points = 60,
                               .gone_from = 25,
                               .gone_until = 30,
                               .stands_from = 25,
                               .stands_until = 30}},
                             6, 45, seed);
    ASSERT_EQ(drive.tracks().size(), 1U) << "seed " << seed;
    const auto all = drive.observations(*drive.tracks().begin());
    const auto positionAt = [&](std::int64_t frame) {
      const auto at = std::ranges::find_if(all, [&](const auto& o) { return o.frame.value == frame; });
      return drive.bodyOnCar(*at, 0).translation();
    };
    EXPECT_LT((positionAt(44) - positionAt(24)).norm(), 1.8) << "seed " << seed;
  }
}

TEST(ObjectTracker, TwoCarsSideBySideAreTwoFromTheFirstFrame) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TrackedDrive drive({{.x_m = -1.5, .z_m = 14, .speed_mps = 10, .points = 80},
                              {.x_m = 1.1, .z_m = 14.5, .speed_mps = 10, .points = 80}},
                             10, 30, seed);
    ASSERT_EQ(drive.tracks().size(), 2U) << "seed " << seed;
    for (const TrackId track : drive.tracks()) {
      const auto all = drive.observations(track);
      EXPECT_GE(all.size(), 27U) << "seed " << seed;
      for (const auto& o : all) EXPECT_EQ(drive.carOf(o, 2), drive.carOf(all.front(), 2)) << "seed " << seed;
    }
  }
}

/// A truck's few points with wrong disparities: a speck behind it and within its outline, at its speed.
TEST(ObjectTracker, AFewPointsSeenThroughAVehicleAreNoVehicle) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const SimulatedCar truck{.x_m = 0.5, .z_m = 10, .speed_mps = 10, .points = 200};
    const SimulatedCar speck{.x_m = 0.7, .z_m = 16, .speed_mps = 10, .points = 20, .size = 0.5};
    EXPECT_EQ(TrackedDrive({speck}, 10, 20, seed).tracks().size(), 1U) << "seed " << seed;
    EXPECT_EQ(TrackedDrive({truck, speck}, 10, 20, seed).tracks().size(), 1U) << "seed " << seed;
  }
}

/// The same beside the points, where the right image's border hides the vehicle.
TEST(ObjectTracker, AFewPointsBesideAVehicleThatIsCutOffAreNoVehicle) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const SimulatedCar truck{.x_m = -4.2, .z_m = 9, .speed_mps = 10, .points = 200};
    const SimulatedCar speck{.x_m = -12.9, .z_m = 16, .speed_mps = 10, .points = 20, .size = 0.5};
    EXPECT_EQ(TrackedDrive({speck}, 10, 20, seed).tracks().size(), 1U) << "seed " << seed;
    EXPECT_EQ(TrackedDrive({truck, speck}, 10, 20, seed).tracks().size(), 1U) << "seed " << seed;
  }
}

TEST(ObjectTracker, ACarThatStopsIsStoppedUntilItMovesAgain) {
  const TrackedDrive drive({{.x_m = 3, .z_m = 20, .speed_mps = 5, .points = 60, .stands_from = 20, .stands_until = 45}},
                           2, 65);
  ASSERT_EQ(drive.tracks().size(), 1U);
  std::map<std::int64_t, ObjectState> state;
  for (const auto& o : drive.observations(*drive.tracks().begin())) state[o.frame.value] = o.state;
  // Half a second for the velocity's filter, which allows 4 m/s^2 while the car stops at once, and three slow frames.
  for (int frame = 6; frame < 20; ++frame) EXPECT_EQ(state.at(frame), ObjectState::kMoving) << frame;
  for (int frame = 32; frame < 45; ++frame) EXPECT_EQ(state.at(frame), ObjectState::kStopped) << frame;
  for (int frame = 52; frame < 65; ++frame) EXPECT_EQ(state.at(frame), ObjectState::kMoving) << frame;
}

TEST(ObjectTracker, ParkedCarsAreNeverReported) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TrackedDrive drive({{.x_m = 4, .z_m = 25, .speed_mps = 0},
                              {.x_m = -4, .z_m = 40, .speed_mps = 0},
                              {.x_m = 5, .z_m = 60, .speed_mps = 0}},
                             10, 30, seed);
    EXPECT_TRUE(drive.tracks().empty()) << "seed " << seed;
  }
}

TEST(ObjectTracker, WhatIsNoLargerThanAHandIsNoVehicle) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const auto follow = [&](double size) {
      return TrackedDrive({{.x_m = 0.5, .z_m = 8, .points = 20, .size = size}}, 10, 20, seed).tracks().size();
    };
    EXPECT_EQ(follow(0.01), 0U) << "seed " << seed;
    EXPECT_EQ(follow(1), 1U) << "seed " << seed;
  }
}

TEST(ObjectTracker, AWalkerIsFollowedOnceItsWayIsLongEnough) {
  int followed = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed)  // across the road, with few points
    followed += TrackedDrive({{.x_m = -3, .z_m = 13, .heading_rad = 1.57, .speed_mps = 1.4, .points = 8, .size = 0.35}},
                             2, 25, seed)
                    .tracks()
                    .size() == 1;
  EXPECT_GE(followed, 4);
}

TEST(ObjectTracker, PointsWithinOnePatchAreNoVehicle) {
  for (std::uint64_t seed = 0; seed < 5; ++seed)  // 20 cm at 16 m: 9 pixels
    EXPECT_TRUE(TrackedDrive({{.x_m = 0.5, .z_m = 16, .points = 30, .size = 0.12}}, 10, 20, seed).tracks().empty())
        << "seed " << seed;
}

TEST(ObjectTracker, TwoCarsThatPassEachOtherKeepTheirIds) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TrackedDrive drive({{.x_m = -1.8, .z_m = 20, .speed_mps = 7}, {.x_m = 1.8, .z_m = 11, .speed_mps = 11}}, 8,
                             40, seed);
    ASSERT_EQ(drive.tracks().size(), 2U) << "seed " << seed;
    for (const TrackId track : drive.tracks()) {
      const auto all = drive.observations(track);
      const std::size_t car = drive.carOf(all.front(), 2);
      for (const auto& o : all) EXPECT_EQ(drive.carOf(o, 2), car) << "seed " << seed << " frame " << o.frame.value;
    }
  }
}

TEST(ObjectTracker, TheBodysXAxisLiesAlongTheTravel) {
  for (const double heading : {0.0, 0.6, 3.1}) {
    const TrackedDrive drive({{.x_m = heading == 0.6 ? -5.0 : -3.0,
                               .z_m = heading > 3 ? 40.0 : 18.0,
                               .heading_rad = heading,
                               .speed_mps = 7}},
                             6, 18);
    ASSERT_FALSE(drive.tracks().empty());
    const auto all = drive.observations(*drive.tracks().begin());
    for (const auto& o : all) {
      const Eigen::Matrix3d R = drive.bodyOnCar(o, 0).rotation();
      // Confirmation comes with velocities good to 0.5 m/s of 7, and distant oncoming cars are seen from the front
      // alone.
      EXPECT_GT(R(0, 0), std::cos(0.14)) << heading;
      EXPECT_GT(R(2, 2), std::cos(0.08)) << heading;  // z up: the prior of the tilt allows 0.03 rad
    }
  }
}

TEST(ObjectTracker, EncounterErrorsAreWithinTheirCovariances) {
  double encounter = 0;
  int encounters = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TrackedDrive drive({{.x_m = -2, .z_m = 12, .speed_mps = 9, .points = 80}}, 8, 25, seed,
                             1e-5);  // the points' noise alone
    ASSERT_FALSE(drive.tracks().empty());
    const auto all = drive.observations(*drive.tracks().begin());
    Vector6d mean =
        Vector6d::Zero();  // where the body sits on the car: chosen by the tracker, known from all its observations
    const SE3 reference = drive.bodyOnCar(all[all.size() / 2], 0);
    for (const auto& o : all)
      mean += (reference.inverse() * drive.bodyOnCar(o, 0)).log() / static_cast<double>(all.size());
    const SE3 T_car_body = reference * SE3::exp(mean);
    for (const auto& o : all) {
      const int frame = static_cast<int>(o.frame.value);
      const SE3 truth = drive.traffic.carInCamera(0, frame) * T_car_body;
      encounter += test::nees((truth.inverse() * o.T_cam_body).log(), o.encounter_covariance);
      ++encounters;
    }
  }
  // Generous: points keep their errors from frame to frame, which covariances of single frames leave out; half to twice
  // the variance.
  EXPECT_LT(encounter / encounters, 12);
  EXPECT_GT(encounter / encounters, 1);
}

TEST(ObjectTracker, EveryFrameGivesItsOutput) {
  ObjectTracker tracker({}, kRig);
  auto lost = std::make_shared<SceneMotion>();
  lost->head.frame = {7};
  lost->head.status = FrameStatus::kRejected;
  const auto answer = tracker(lost);
  EXPECT_EQ(answer->head.frame, FrameId{7});
  EXPECT_EQ(answer->head.status, FrameStatus::kRejected);
  EXPECT_TRUE(answer->objects.empty());
}

TEST(ObjectTracker, FollowsNoMoreObjectsThanItMay) {
  std::vector<SimulatedCar> cars;
  for (int i = 0; i < 6; ++i)
    cars.push_back({.x_m = -7.5 + 3.0 * i, .z_m = 14.0 + 3.0 * ((i + 2) % 4), .speed_mps = 12});
  for (const int most : {2, 64}) {
    SimulatedTraffic traffic(cars, 8, 1, 0.003);
    ObjectTracker::Params params;
    params.max_objects = most;
    ObjectTracker tracker(params, kRig);
    std::size_t most_at_once = 0;
    for (int i = 0; i < 12; ++i) {
      const auto frame = tracker(traffic.next());
      const auto now = [&](const ObjectObservation& o) { return o.frame == frame->head.frame; };
      most_at_once = std::max<std::size_t>(most_at_once, std::ranges::count_if(frame->objects, now));
    }
    if (most == 2) {
      EXPECT_EQ(most_at_once, 2U);
    } else {
      EXPECT_GT(most_at_once, 3U);
    }
  }
}

}  // namespace
}  // namespace motorcade
