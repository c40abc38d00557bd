#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "apps/synth/models/models.hpp"
#include "apps/synth/scenes/frame_scene.hpp"
#include "apps/synth/scenes/scene_builder.hpp"

namespace motorcade::synth {
namespace {

TEST(SynthGardens, AFenceShowsWhatIsBehindIt) {
  const Model fence = makePicketFence(8, 5);
  int stopped = 0, rays = 0;
  for (float x = -3.9F; x < 3.9F; x += 0.013F, ++rays) {
    const bool hit = std::any_of(fence.parts.begin(), fence.parts.end(), [&](const Primitive& part) {
      return intersect(part, fence.cuts.data(), {x, -5, 0.6F}, {0, 1, 0}, 0, 100).has_value();
    });
    stopped += hit ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(stopped) / rays, 0.05 / 0.14, 0.03);  // width of a picket over their distance
}

/// The branches of all trees in a frame.
std::vector<Eigen::Vector3d> branches(const Scene& scene, int frame) {
  std::vector<Eigen::Vector3d> places;
  const FrameScene placed_scene(scene, frame, false);
  for (const Placed& placed : placed_scene.placed())
    if (placed.limb && placed.model->parts[0].material == Material::kFoliage)
      places.push_back(placed.T_map_body.translation());
  return places;
}

TEST(SynthGardens, CrownsSwaySmoothlyByCentimeters) {
  const Scene scene = makeScene("windy", 1);
  const auto start = branches(scene, 0);
  double farthest_m = 0;
  auto last = start;
  for (int k = 1; k < 40; ++k) {
    const auto now = branches(scene, k);
    ASSERT_EQ(now.size(), start.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
      farthest_m = std::max(farthest_m, (now[i] - start[i]).norm());
      ASSERT_LT((now[i] - last[i]).norm(), 0.06);  // 0.15 m times the sines' summed slopes, 4 rad/s at most
    }
    last = now;
  }
  EXPECT_GT(farthest_m, 0.12);
  EXPECT_LT(farthest_m, 0.30);  // from one end of the widest sway to the other
}

TEST(SynthGardens, TreesAreNoObjects) {
  const Scene scene = makeScene("windy", 1);
  const FrameScene frame(scene, 10, true);
  for (const auto& object : frame.objects()) EXPECT_FALSE(object.front().model->kitti_type.empty());
  EXPECT_EQ(scene.movers.size(), 1U);
}

TEST(SynthGardens, ParkedCarsStandOnBothSides) {
  const Scene scene = makeScene("parked", 1);
  EXPECT_TRUE(scene.movers.empty());
  const auto right = [&](const Fixture& fixture) {
    const auto p = fixture.T_map_body.translation();
    return scene.roads.locate(p.x(), p.y()).left_m < 0;
  };
  const auto isCar = [](const Fixture& fixture) { return fixture.id >= 0; };
  std::vector<Fixture> cars;
  std::copy_if(scene.fixtures.begin(), scene.fixtures.end(), std::back_inserter(cars), isCar);
  const auto on_right = std::count_if(cars.begin(), cars.end(), right);
  EXPECT_GT(on_right, 30);  // of 39 spaces
  EXPECT_GT(static_cast<std::ptrdiff_t>(cars.size()) - on_right, 30);
}

}  // namespace
}  // namespace motorcade::synth
