#include "apps/synth/models/street_model.hpp"

#include <numbers>

namespace motorcade::synth {

Model makeBuilding(float length_m, float depth_m, float height_m, std::uint32_t seed) {
  Model m;
  Random random(seed);
  const float x = 0.5F * length_m, y = 0.5F * depth_m;
  const auto material = random.chance(0.5F) ? Material::kBrick : Material::kPlaster;
  const float tone = material == Material::kBrick ? random.uniform(0.16F, 0.32F) : random.uniform(0.32F, 0.68F);
  m.add(material, {-x, -y, 0}, {x, y, height_m}, tone, seed);
  m.add(Material::kRoof, {-x - 0.3F, -y - 0.4F, height_m}, {x + 0.3F, y + 0.4F, height_m + 0.25F}, 0.22F, seed);
  if (random.chance(0.7F)) {  // pitched roof
    m.add(Material::kRoof, {-x, -y - 0.3F, height_m + 0.2F}, {x, y + 0.3F, height_m + 3.2F}, 0.17F, seed + 1);
    m.cutLast({0, 3.0F, y}, {0, y + 0.3F, height_m + 0.3F});
    m.cutLast({0, -3.0F, y}, {0, -y - 0.3F, height_m + 0.3F});
    m.add(Material::kBrick, {0.3F * x, -0.8F, height_m}, {0.3F * x + 0.7F, 0, height_m + 3.9F}, 0.25F, seed + 2);
  }
  for (float story = 4; story < height_m - 2 && random.chance(0.8F); story += 3.1F)  // balconies
    for (float at = -x + 2.5F; at < x - 2.5F; at += 4.5F)
      for (const float side : {-1.0F, 1.0F})
        if (random.chance(0.5F))
          m.add(Material::kWood, {at, side * y, story}, {at + 2.2F, side * (y + 0.9F), story + 0.95F},
                random.uniform(0.2F, 0.6F), random.bits());
  return m;
}

Model makeTree(float height_m, std::uint32_t seed) {
  Model m;
  Random random(seed);
  const float radius = random.uniform(0.12F, 0.24F), crown = 0.42F * height_m;
  m.addCylinder(Material::kBark, 2, {-radius, -radius, 0}, {radius, radius, 0.75F * height_m}, 0.15F, seed);
  const int blobs = 8;
  const float tone = random.uniform(0.09F, 0.20F);
  for (int i = 0; i < blobs; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * (static_cast<float>(i) + random.uniform(0, 0.6F)) / blobs;
    const float out = i == 0 ? 0 : random.uniform(0.35F, 0.7F) * crown, size = crown * random.uniform(0.36F, 0.58F);
    const Vec3 center{out * std::cos(angle), out * std::sin(angle), height_m - crown * random.uniform(0.45F, 1.05F)};
    m.addEllipsoid(Material::kLeaves, center, {size, size, 0.8F * size}, tone * random.uniform(0.8F, 1.3F),
                   random.bits());
  }
  return m;
}

Model makeBush(float length_m, std::uint32_t seed) {
  Model m;
  Random random(seed);
  for (float x = -0.5F * length_m; x < 0.5F * length_m; x += 0.9F) {
    const float r = random.uniform(0.6F, 1.1F);
    m.addEllipsoid(Material::kLeaves, {x, random.uniform(-0.3F, 0.3F), 0.7F * r}, {r, 0.8F * r, r},
                   random.uniform(0.09F, 0.24F), random.bits());
  }
  return m;
}

Model makeHedge(float length_m, float height_m, std::uint32_t seed) {
  Model m;
  m.add(Material::kHedge, {-0.5F * length_m, -0.45F, 0}, {0.5F * length_m, 0.45F, height_m}, 0.14F, seed);
  m.cutLast({0, 1, 0.4F}, {0, 0.45F, height_m - 0.25F});
  m.cutLast({0, -1, 0.4F}, {0, -0.45F, height_m - 0.25F});
  return m;
}

Model makeFence(float length_m, std::uint32_t seed) {
  Model m;
  Random random(seed);
  const float x = 0.5F * length_m, tone = random.uniform(0.12F, 0.5F);
  if (random.chance(0.4F)) {
    m.add(Material::kWood, {-x, -0.03F, 0}, {x, 0.03F, 1.5F}, tone, seed);
  } else {
    for (const float z : {0.35F, 1.05F}) m.add(Material::kMetal, {-x, -0.02F, z}, {x, 0.02F, z + 0.06F}, tone, seed);
    for (float at = -x; at < x; at += 0.3F)
      m.add(Material::kMetal, {at, -0.015F, 0}, {at + 0.03F, 0.015F, 1.25F}, tone, seed);
  }
  for (float at = -x; at <= x + 0.01F; at += 0.5F * length_m)
    m.add(Material::kConcrete, {at - 0.08F, -0.08F, 0}, {at + 0.08F, 0.08F, 1.65F}, 0.45F, seed + 1);
  return m;
}

Model makeLampPost(std::uint32_t seed) {
  Model m;
  m.addCylinder(Material::kMetal, 2, {-0.07F, -0.07F, 0}, {0.07F, 0.07F, 7.5F}, 0.35F, seed);
  m.addCylinder(Material::kMetal, 2, {-0.12F, -0.12F, 0}, {0.12F, 0.12F, 1.1F}, 0.28F, seed);
  m.add(Material::kMetal, {-0.05F, -1.6F, 7.4F}, {0.05F, 0, 7.5F}, 0.35F, seed);
  m.add(Material::kPlastic, {-0.15F, -2.1F, 7.35F}, {0.15F, -1.4F, 7.5F}, 0.6F, seed);
  if ((seed & 3U) == 0) m.add(Material::kSign, {-0.03F, -0.35F, 2.3F}, {0.03F, 0.35F, 3.1F}, 0.7F, seed + 1);
  return m;
}

Model makeTrafficSign(std::uint32_t seed) {
  Model m;
  Random random(seed);
  m.addCylinder(Material::kMetal, 2, {-0.04F, -0.04F, 0}, {0.04F, 0.04F, 2.9F}, 0.4F, seed);
  const float width = random.uniform(0.3F, 0.55F);
  m.add(Material::kSign, {-0.07F, -width, 2.1F}, {-0.045F, width, 2.1F + 2 * random.uniform(0.25F, 0.5F)},
        random.chance(0.6F) ? 0.75F : 0.12F, seed);
  return m;
}

Model makeGuardRail(float length_m, std::uint32_t seed) {
  Model m;
  const float x = 0.5F * length_m;
  m.add(Material::kMetal, {-x, -0.04F, 0.45F}, {x, 0.04F, 0.58F}, 0.42F, seed);
  m.add(Material::kMetal, {-x, -0.04F, 0.63F}, {x, 0.04F, 0.76F}, 0.48F, seed + 1);
  for (float at = -x; at < x; at += 2)
    m.add(Material::kMetal, {at, -0.05F, 0}, {at + 0.12F, 0.05F, 0.8F}, 0.25F, seed + 2);
  for (float at = -x + 1; at < x; at += 12)
    m.add(Material::kSign, {at - 0.02F, -0.1F, 0.8F}, {at + 0.02F, 0.1F, 1.1F}, 0.8F, seed + 3);
  return m;
}

Model makeStreetClutter(std::uint32_t seed) {
  Model m;
  Random random(seed);
  switch (random.bits() % 4) {
    case 0:  // bin
      m.addCylinder(Material::kPlastic, 2, {-0.25F, -0.25F, 0}, {0.25F, 0.25F, 0.95F}, random.uniform(0.05F, 0.4F),
                    seed);
      m.add(Material::kSign, {-0.26F, -0.12F, 0.4F}, {-0.2F, 0.12F, 0.7F}, 0.7F, seed);
      break;
    case 1:  // switch box
      m.add(Material::kConcrete, {-0.5F, -0.2F, 0}, {0.5F, 0.2F, 1.2F}, random.uniform(0.3F, 0.6F), seed);
      m.add(Material::kSign, {-0.3F, -0.22F, 0.5F}, {0.3F, 0.22F, 1.0F}, random.uniform(0.3F, 0.8F), seed);
      break;
    case 2:  // bollards
      for (const float x : {-1.4F, 0.0F, 1.4F}) {
        m.addCylinder(Material::kMetal, 2, {x - 0.07F, -0.07F, 0}, {x + 0.07F, 0.07F, 0.9F}, 0.1F, seed);
        m.addCylinder(Material::kMetal, 2, {x - 0.075F, -0.075F, 0.65F}, {x + 0.075F, 0.075F, 0.78F}, 0.8F, seed);
      }
      break;
    default:  // advertising column
      m.addCylinder(Material::kConcrete, 2, {-0.6F, -0.6F, 0}, {0.6F, 0.6F, 0.5F}, 0.35F, seed);
      m.add(Material::kSign, {-0.6F, -0.1F, 0.5F}, {0.6F, 0.1F, 2.3F}, 0.6F, seed);
  }
  return m;
}

}  // namespace motorcade::synth
