#include <gtest/gtest.h>

#include "apps/synth/models/models.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/textures/texture.hpp"

namespace motorcade::synth {
namespace {

/// Reflectance along a wall or roof part, every centimeter for 10 m.
std::vector<float> alongX(const Model& model, Material material, const Vec3& normal, float z) {
  const auto part =
      std::find_if(model.parts.begin(), model.parts.end(), [&](const Primitive& p) { return p.material == material; });
  std::vector<float> tones;
  for (int i = 0; i < 1000; ++i)
    tones.push_back(
        houseReflectance({&*part, &model, {0.01F * static_cast<float>(i) - 5, 0, z}, normal, 0.01F}).diffuse);
  return tones;
}

/// Mean square difference to the same pattern further on, over its variance: 0 where it repeats, 2 where it does not.
float differenceAfter(const std::vector<float>& tones, std::size_t shift) {
  float mean = 0, variance = 0, difference = 0;
  for (const float tone : tones) mean += tone / static_cast<float>(tones.size());
  for (std::size_t i = 0; i + shift < tones.size(); ++i) {
    variance += (tones[i] - mean) * (tones[i] - mean);
    difference += (tones[i] - tones[i + shift]) * (tones[i] - tones[i + shift]);
  }
  return difference / variance;
}

TEST(SynthHouses, BricksAndTilesRepeat) {
  const auto bricks = alongX(makeTerrace(24, 8, 7, 0.17F), Material::kBrickwork, {0, 1, 0}, 1.06F);
  const auto tiles = alongX(makeCottage(10, 8, 3), Material::kTiles, {0, 0.62F, 0.78F}, 3.6F);
  constexpr float kAlike = 0.4F;  // each piece has a shade of its own
  EXPECT_LT(differenceAfter(bricks, 25), kAlike);
  EXPECT_GT(differenceAfter(bricks, 12), 1.5F);
  EXPECT_LT(differenceAfter(tiles, 26), kAlike);
  EXPECT_GT(differenceAfter(tiles, 13), 1.5F);
}

TEST(SynthHouses, SlatsAreLevelLinesThatRepeat) {
  const Model cottage = makeCottage(10, 8, 3);
  const auto part = std::find_if(cottage.parts.begin(), cottage.parts.end(),
                                 [](const Primitive& p) { return p.material == Material::kSlats; });
  const auto at = [&](float along_m, float up_m) {
    const Vec3 p{0.5F * (part->lo.x + part->hi.x) + along_m, 0, part->lo.z + up_m};
    return houseReflectance({&*part, &cottage, p, {0, 1, 0}, 0.004F}).diffuse;
  };
  EXPECT_EQ(at(-0.1F, 0.23F), at(0.1F, 0.23F));
  EXPECT_GT(at(0, 0.21F), 1.5F * at(0, 0.23F));  // a slat, the gap below
  EXPECT_NEAR(at(0, 0.23F), at(0, 0.23F + 2 * 0.055F), 1e-3);
}

TEST(SynthHouses, NothingMovesAtTheCornerAndOneCarBetweenTheBricks) {
  EXPECT_EQ(makeScene("corner", 1).objectCount(), 0);
  for (const std::uint32_t seed : {1U, 2U}) {
    const Scene scene = makeScene("brick", seed);
    ASSERT_EQ(scene.movers.size(), 1U);
    EXPECT_EQ(scene.movers[0].trajectory.backwards, seed % 2 == 1);
  }
  const Trajectory ego = makeScene("brick", 1).ego.trajectory;
  EXPECT_NEAR(ego.speedAt_mps(0), 8, 0.3);
  EXPECT_EQ(ego.speedAt_mps(0), ego.speedAt_mps(8));
}

TEST(SynthHouses, TheEgoCarTurnsTheCorner) {
  const Scene scene = makeScene("corner", 1);
  const auto ahead = [&](int frame) -> Eigen::Vector3d {
    return scene.ego.trajectory.T_map_body(scene.time_s(frame)).rotation().col(0);
  };
  EXPECT_NEAR(ahead(0).dot(ahead(scene.frames - 1)), 0, 0.02);
}

}  // namespace
}  // namespace motorcade::synth
