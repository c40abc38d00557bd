#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "apps/synth/rendering/ray_caster.hpp"
#include "apps/synth/rendering/ray_tree.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "apps/synth/textures/texture.hpp"
#include "tests/apps/synth/rendered_scene.hpp"

namespace motorcade::synth {
namespace {

/// A board across an empty road, 14 m ahead.
Scene boardAhead(float tone, bool rain) {
  Scene scene;
  scene.rain = rain;
  scene.sun = normalized({0.1F, 0.2F, 1});  // the board's shadow falls behind it, or nearly
  const auto road = std::make_shared<const Path>(Eigen::Vector2d(-20, 0), 0, std::vector<Path::Piece>{{120, 0}});
  scene.roads = RoadNetwork({Road{road, 12, {}}});
  scene.ego.trajectory.path = road;
  scene.ego.trajectory.start_m = 20;
  Model board;
  board.add(Material::kPlastic, {-0.1F, -4, 0}, {0.1F, 4, 3}, tone);
  scene.fixtures.push_back(
      {std::make_shared<const Model>(std::move(board)), SE3(Eigen::Matrix3d::Identity(), {14, 0, 0}), -1});
  return scene;
}

/// Mean gray level of the road in a window of rows that lie `from_m` to `to_m` before the camera.
double roadLevel(const Scene& scene, double from_m, double to_m) {
  const FrameScene frame(scene, 0, true);
  const Rendering left = render(frame, kSmallCamera, StereoSide::kLeft, kNoNoise);
  double sum = 0;
  int count = 0;
  for (int y = 0; y < kSmallCamera.height_px; ++y)
    for (int x = 150; x < 260; ++x) {
      const auto depth = static_cast<double>(left.depth_m[y * kSmallCamera.width_px + x]);
      if (depth < from_m || depth > to_m) continue;
      sum += left.image.at(x, y);
      ++count;
    }
  EXPECT_GT(count, 200);
  return sum / count;
}

TEST(SynthRain, AWetRoadMirrorsWhatStandsOnItAndADryOneDoesNot) {
  const double light = roadLevel(boardAhead(0.8F, true), 9, 12), dark = roadLevel(boardAhead(0.03F, true), 9, 12);
  EXPECT_GT(light, dark + 25);
  EXPECT_NEAR(roadLevel(boardAhead(0.8F, false), 9, 12), roadLevel(boardAhead(0.03F, false), 9, 12), 0.1);
}

TEST(SynthRain, AWetRoadIsDarkerWhereItMirrorsLittle) {
  const Scene wet = boardAhead(0.03F, true);
  const FrameScene frame(wet, 0, true);
  const Ground ground(frame);
  const auto hit = ground.hit({}, {0.3F, 0, -1}, 100);
  ASSERT_TRUE(hit);
  const WaterFilm film = waterFilm(*hit, 0.01F, wet, 0);
  EXPECT_LT(film.darkening, 0.6F);
  EXPECT_GT(film.mirror, 0.5F);
  EXPECT_NEAR(waterReflectance(1), 0.02F, 1e-6F);
  EXPECT_GT(waterReflectance(0.1F), 0.5F);
}

TEST(SynthRain, TruthIsThatOfTheFirstSurface) {
  for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
    Scene scene = makeScene("rain", 1);
    const Rendering wet = render(FrameScene(scene, 20, true), kSmallCamera, side, kNoNoise);
    scene.rain = false;
    const Rendering dry = render(FrameScene(scene, 20, true), kSmallCamera, side, kNoNoise);
    EXPECT_EQ(wet.depth_m, dry.depth_m);
    EXPECT_EQ(wet.object, dry.object);
    EXPECT_NE(pixels(wet.image), pixels(dry.image));
  }
}

TEST(SynthPaint, SmoothPaintHasNoTextureAndTheSameShape) {
  const Model rough = makeVehicle(VehicleKind::kCar, 9, Finish::kDark),
              smooth = makeVehicle(VehicleKind::kCar, 9, Finish::kSmoothDark);
  ASSERT_EQ(rough.parts.size(), smooth.parts.size());
  const auto spread = [](const Model& model) {
    float least = 1e9F, most = 0;
    for (float x = -0.3F; x < 0.2F; x += 0.05F) {
      const SurfacePoint point{&model.parts.front(), &model, {x, 0.85F, 0.8F}, {0, 1, 0}, 0.01F, 0};
      const float tone = reflectanceOf(point).diffuse;
      least = std::min(least, tone);
      most = std::max(most, tone);
    }
    return most / least;
  };
  EXPECT_GT(spread(rough), 1.2F);
  EXPECT_FLOAT_EQ(spread(smooth), 1);
  EXPECT_TRUE(smooth.smooth_paint);
  EXPECT_LT(smooth.parts.front().tone, 0.03F);
}

TEST(SynthRays, TheTreeFindsWhatTryingEveryPartFinds) {
  const Scene scene = makeScene("people", 2);
  const FrameScene frame(scene, 40, true);
  const RayTree tree(frame);
  Random random(8);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 origin{random.uniform(-5, 30), random.uniform(-9, 9), random.uniform(-1.5F, 2)};
    const Vec3 direction = normalized({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.3F, 0.6F)});
    const auto hit = tree.firstHit(origin, direction, 80);
    const float t = nearestOfAll(frame, origin, direction, 1e-3F, 80);
    ASSERT_NEAR(hit ? hit->t : 80, t, 1e-4F) << i;
    hits += hit ? 1 : 0;
  }
  EXPECT_GT(hits, 1000);
}

}  // namespace
}  // namespace motorcade::synth
