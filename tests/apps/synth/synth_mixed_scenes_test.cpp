#include <algorithm>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "apps/synth/output/ground_truth.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "tests/apps/synth/rendered_scene.hpp"

namespace motorcade::synth {
namespace {

/// Frames in which a mover of a type moves within 30 m and in view, by id.
std::map<int, int> framesInView(const Scene& scene, const std::string& type) {
  std::map<int, int> frames;
  for (int k = 0; k < scene.frames; ++k) {
    const double t_s = scene.time_s(k);
    for (const Mover& mover : scene.movers) {
      if (mover.model->kitti_type != type || mover.trajectory.speedAt_mps(t_s) < 1) continue;
      const Eigen::Vector3d p_cam = scene.ego.T_map_cam(t_s).inverse() * mover.trajectory.T_map_body(t_s).translation();
      const auto uvd = kSmallCamera.project(p_cam);
      if (uvd && p_cam.z() < 30 && kSmallCamera.inLeftImage(uvd->x(), 0.5 * kSmallCamera.height_px, 0))
        ++frames[mover.id];
    }
  }
  return frames;
}

constexpr int kManyFrames = 12;

TEST(SynthMixedScenes, ShowTheirKindsMovingWithin30MetersForManyFrames) {
  struct Expected {
    const char *scene, *type;
    int movers;
  };
  for (const Expected& expected :
       {Expected{"people", "Pedestrian", 6}, Expected{"people", "Cyclist", 3}, Expected{"traffic", "Truck", 1},
        Expected{"traffic", "Trailer", 1}, Expected{"traffic", "Bus", 1}, Expected{"traffic", "Cyclist", 2},
        Expected{"traffic", "Pedestrian", 3}, Expected{"traffic", "Car", 3}, Expected{"rain", "Bus", 1},
        Expected{"rain", "Car", 3}, Expected{"rain", "Cyclist", 1}, Expected{"rain", "Pedestrian", 3}})
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
      const auto frames = framesInView(makeScene(expected.scene, seed), expected.type);
      const auto seen_long =
          std::count_if(frames.begin(), frames.end(), [](const auto& f) { return f.second >= kManyFrames; });
      EXPECT_GE(seen_long, expected.movers) << expected.scene << " seed " << seed << " " << expected.type;
    }
}

TEST(SynthMixedScenes, EveryLabelHasItsMaskAndEveryMaskItsLabel) {
  for (const char* name : {"traffic", "rain", "people"}) {
    const Scene scene = makeScene(name, 3);
    for (const int k : {0, 60}) {
      const FrameScene frame(scene, k, true);
      const Rendering left = render(frame, kSmallCamera, StereoSide::kLeft, kNoNoise);
      std::map<int, int> pixels;
      for (const std::int16_t id : left.object)
        if (id >= 0) ++pixels[id];
      std::set<int> labeled, large;
      for (const Label& label : labelsOf(frame, kSmallCamera, left)) labeled.insert(label.id);
      constexpr int kLeastPixels = 12;  // labelsOf's
      for (const auto& [id, count] : pixels)
        if (count >= kLeastPixels) large.insert(id);
      EXPECT_EQ(labeled, large) << name << " frame " << k;
    }
  }
}

/// True when someone at a point of the map, of this radius, stands in a fixture's lower parts.
bool standsIn(const Fixture& fixture, const Eigen::Vector3d& p_map, float radius_m) {
  constexpr float kOverhead_m = 1.9F;
  const Eigen::Vector3d p = fixture.T_map_body.inverse() * p_map;
  const auto x = static_cast<float>(p.x()), y = static_cast<float>(p.y());
  return std::any_of(fixture.model->parts.begin(), fixture.model->parts.end(), [&](const Primitive& part) {
    return part.lo.z < kOverhead_m && x > part.lo.x - radius_m && x < part.hi.x + radius_m &&
           y > part.lo.y - radius_m && y < part.hi.y + radius_m;
  });
}

TEST(SynthMixedScenes, NobodyWalksOrRidesThroughWhatStandsAtTheRoadside) {
  constexpr float kRadius_m = 0.25F;
  for (const char* name : {"traffic", "rain", "people"})
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
      const Scene scene = makeScene(name, seed);
      for (const Mover& mover : scene.movers) {
        if (mover.model->kitti_type != "Pedestrian" && mover.model->kitti_type != "Cyclist") continue;
        for (int k = 0; k < scene.frames; k += 2) {
          const Eigen::Vector3d p = mover.trajectory.T_map_body(scene.time_s(k)).translation();
          for (const Fixture& fixture : scene.fixtures)
            ASSERT_FALSE(standsIn(fixture, p, kRadius_m))
                << name << " seed " << seed << " frame " << k << ": " << mover.id << " at " << p.transpose();
        }
      }
    }
}

TEST(SynthMixedScenes, PeopleStandOnRoadAndPavement) {
  const Scene scene = makeScene("people", 1);
  constexpr double kCurb_m = 0.12, kAcross_m = 1.7;  // where the way leads down and up
  bool road = false, pavement = false;
  for (const Mover& mover : scene.movers) {
    if (mover.model->kitti_type != "Pedestrian") continue;
    for (int k = 0; k < scene.frames; ++k) {
      const Eigen::Vector3d p = mover.trajectory.T_map_body(scene.time_s(k)).translation();
      const double outside_m = static_cast<double>(scene.roads.locate(p.x(), p.y()).outside_m);
      EXPECT_GE(p.z(), outside_m > -0.1 ? kCurb_m - 1e-6 : 0.0);
      if (outside_m < -kAcross_m) {
        EXPECT_NEAR(p.z(), 0, 1e-6);
      }
      road = road || outside_m < -kAcross_m;
      pavement = pavement || outside_m > 0;
    }
  }
  EXPECT_TRUE(road && pavement);
}

TEST(SynthMixedScenes, AreTheSameForASeedOnAnyNumberOfThreads) {
  const StereoCamera camera = kittiCamera(248, 75);
  for (const char* name : {"traffic", "rain", "people"}) {
    const auto picture = [&](std::uint32_t seed, int threads) {
      const Scene scene = makeScene(name, seed);
      return pixels(render(FrameScene(scene, 30, true), camera, StereoSide::kLeft, {.threads = threads}).image);
    };
    EXPECT_EQ(picture(4, 1), picture(4, 3)) << name;
    EXPECT_NE(picture(4, 3), picture(5, 3)) << name;
  }
}

TEST(SynthMixedScenes, ATrailerFollowsItsTruck) {
  constexpr double kHitch_m = 0.6;  // between rear end and drawbar
  const Scene scene = makeScene("traffic", 2);
  for (int k = 0; k < scene.frames; k += 10) {
    const double t_s = scene.time_s(k);
    for (std::size_t i = 0; i + 1 < scene.movers.size(); ++i) {
      const Mover &truck = scene.movers[i], &trailer = scene.movers[i + 1];
      if (trailer.model->kitti_type != "Trailer") continue;
      EXPECT_EQ(truck.model->kitti_type, "Truck");
      const Eigen::Vector3d rear =
                                truck.trajectory.T_map_body(t_s) * Eigen::Vector3d(-0.5 * truck.model->length_m, 0, 0),
                            front = trailer.trajectory.T_map_body(t_s) *
                                    Eigen::Vector3d(0.5 * trailer.model->length_m, 0, 0);
      EXPECT_LT((rear - front).norm(), kHitch_m);
    }
  }
}

}  // namespace
}  // namespace motorcade::synth
