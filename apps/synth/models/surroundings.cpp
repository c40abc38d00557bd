#include <numbers>

#include "apps/synth/models/models.hpp"

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
        if (random.chance(0.5F)) {
          const std::uint32_t grain = random.bits();
          m.add(Material::kWood, {at, side * y, story}, {at + 2.2F, side * (y + 0.9F), story + 0.95F},
                random.uniform(0.2F, 0.6F), grain);
        }
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
    const std::uint32_t leaves = random.bits();
    m.addEllipsoid(Material::kLeaves, center, {size, size, 0.8F * size}, tone * random.uniform(0.8F, 1.3F), leaves);
  }
  return m;
}

Model makeBush(float length_m, std::uint32_t seed) {
  Model m;
  Random random(seed);
  for (float x = -0.5F * length_m; x < 0.5F * length_m; x += 0.9F) {
    const float r = random.uniform(0.6F, 1.1F);
    const std::uint32_t leaves = random.bits();
    const float tone = random.uniform(0.09F, 0.24F), y = random.uniform(-0.3F, 0.3F);
    m.addEllipsoid(Material::kLeaves, {x, y, 0.7F * r}, {r, 0.8F * r, r}, tone, leaves);
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
  const float width = random.uniform(0.3F, 0.55F), tone = random.chance(0.6F) ? 0.75F : 0.12F;
  const float top = 2.1F + 2 * random.uniform(0.25F, 0.5F);
  m.add(Material::kSign, {-0.07F, -width, 2.1F}, {-0.045F, width, top}, tone, seed);
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

namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

/// Gusts that bend a tree, and the tremor of one of its branches.
struct Wind {
  double reach_m, towards_rad, gust_rad, tremor_rad;

  /// A smooth sum of sines in [-1, 1].
  double lean(double t_s) const {
    return 0.5 * std::sin(kTwoPi * 0.27 * t_s + gust_rad) + 0.3 * std::sin(kTwoPi * 0.46 * t_s + 2.1 * gust_rad) +
           0.2 * std::sin(kTwoPi * 0.83 * t_s + tremor_rad);
  }
  Limb::Pose at(double t_s, const Vec3& rest) const {
    constexpr double kTurn_rad_per_m = 0.3;
    const double moved_m = reach_m * lean(t_s);
    const Vec3 way{static_cast<float>(moved_m * std::cos(towards_rad)),
                   static_cast<float>(moved_m * std::sin(towards_rad)), 0};
    return {rest + way, kTurn_rad_per_m * moved_m};
  }
};

/// One side of a house: things stand out from it.
class Wall {
 public:
  /// The side that looks along axis 0 or 1, forwards or backwards, `distance_m` from the middle.
  Wall(Model& model, int axis, float sign, float distance_m)
      : model_(model), axis_(axis), sign_(sign), distance_m_(distance_m) {}

  struct Span {
    float from, to;
  };
  void add(Material material, const Span& along, const Span& height, float out_m, float tone, std::uint32_t seed = 0) {
    constexpr float kInside_m = 0.05F;
    Vec3 lo{along.from, along.from, height.from}, hi{along.to, along.to, height.to};
    lo[axis_] = sign_ * (distance_m_ - kInside_m);
    hi[axis_] = sign_ * (distance_m_ + out_m);
    model_.add(material, lo, hi, tone, seed);
  }

 private:
  Model& model_;
  int axis_;
  float sign_, distance_m_;
};

void addShutteredWindow(Wall& wall, float at, float tone, std::uint32_t seed) {
  constexpr float kHalf_m = 0.55F, kShutter_m = 0.52F;
  const Wall::Span height{0.95F, 2.25F};
  wall.add(Material::kPane, {at - kHalf_m, at + kHalf_m}, height, 0.03F, 0.7F, seed);
  wall.add(Material::kConcrete, {at - kHalf_m - 0.06F, at + kHalf_m + 0.06F}, {0.87F, 0.95F}, 0.12F, 0.55F, seed);
  for (const float side : {-1.0F, 1.0F}) {
    const float hinge = at + side * (kHalf_m + 0.01F), end = hinge + side * kShutter_m;
    wall.add(Material::kSlats, {std::fmin(hinge, end), std::fmax(hinge, end)}, height, 0.06F, tone, seed);
  }
}

/// Windows 2.9 m apart, as many as fit.
void addWindows(Model& model, int axis, float length_m, float distance_m, float tone) {
  constexpr float kEvery_m = 2.9F;
  const int windows = static_cast<int>((length_m - 0.6F) / kEvery_m);
  for (const float sign : {-1.0F, 1.0F}) {
    Wall wall(model, axis, sign, distance_m);
    for (int i = 0; i < windows; ++i)
      addShutteredWindow(wall, kEvery_m * (static_cast<float>(i) - 0.5F * static_cast<float>(windows - 1)), tone, 7);
  }
}

void addHippedRoof(Model& model, const Vec3& eaves, float tone, std::uint32_t seed) {
  constexpr float kPitch = 0.8F;  // rise over run
  const float rise = kPitch * std::fmin(eaves.x, eaves.y);
  model.add(Material::kTiles, {-eaves.x, -eaves.y, eaves.z}, {eaves.x, eaves.y, eaves.z + rise}, tone, seed);
  for (const float side : {-1.0F, 1.0F}) {
    model.cutLast({0, side, 1 / kPitch}, {0, side * eaves.y, eaves.z});
    model.cutLast({side, 0, 1 / kPitch}, {side * eaves.x, 0, eaves.z});
  }
}

void addTerraceBay(Wall& wall, float at, float height_m, float tone) {
  constexpr float kStory_m = 3.2F;
  wall.add(Material::kBrickwork, {at - 2, at - 1.5F}, {0, height_m - 0.3F}, 0.13F, 0.8F * tone, 3);
  for (float floor = 0; floor + kStory_m < height_m; floor += kStory_m) {
    const Wall::Span width{at - 0.35F, at + 0.85F};
    wall.add(Material::kPane, width, {floor + 1.0F, floor + 2.5F}, 0.02F, 0.65F, 5);
    wall.add(Material::kConcrete, {width.from - 0.1F, width.to + 0.1F}, {floor + 0.88F, floor + 1.0F}, 0.1F, 0.5F, 6);
  }
}

}  // namespace

Model makePicketFence(float length_m, std::uint32_t seed) {
  constexpr float kPicket_m = 0.05F, kEvery_m = 0.14F, kHeight_m = 1.05F, kPost_m = 0.1F;
  Model m;
  Random random(seed);
  const float x = 0.5F * length_m, tone = random.chance(0.5F) ? random.uniform(0.5F, 0.7F) : random.uniform(0.1F, 0.2F);
  for (float at = -x; at < x; at += kEvery_m)
    m.add(Material::kBark, {at, -0.012F, 0.08F}, {at + kPicket_m, 0.012F, kHeight_m}, tone, random.bits());
  for (const float z : {0.25F, 0.85F})
    m.add(Material::kBark, {-x, 0.012F, z}, {x, 0.05F, z + 0.07F}, 0.9F * tone, random.bits());
  for (const float at : {-x, 0.0F, x})
    m.add(Material::kBark, {at - 0.5F * kPost_m, 0.05F, 0}, {at + 0.5F * kPost_m, 0.05F + kPost_m, kHeight_m + 0.1F},
          tone, random.bits());
  return m;
}

Model makeSwayingTree(float height_m, std::uint32_t seed) {
  constexpr int kBranches = 11;
  constexpr float kLowest_m = 0.03F, kHighest_m = 0.15F;
  Model m;
  m.sways = true;
  Random random(seed);
  const float radius = random.uniform(0.1F, 0.16F), crown = 0.36F * height_m, tone = random.uniform(0.1F, 0.2F);
  m.addCylinder(Material::kBark, 2, {-radius, -radius, 0}, {radius, radius, 0.58F * height_m}, 0.15F, seed);
  const double towards_rad = random.uniform(0, 6.28F), gust_rad = random.uniform(0, 6.28F);
  for (int i = 0; i < kBranches; ++i) {
    const float angle = static_cast<float>(kTwoPi) * (static_cast<float>(i) + random.uniform(0, 0.6F)) / kBranches;
    const float out = i == 0 ? 0 : random.uniform(0.4F, 0.8F) * crown, size = crown * random.uniform(0.34F, 0.5F);
    const float up = i == 0 ? 0.3F : random.uniform(0, 1);  // the first one hides the trunk's end
    const Vec3 rest{out * std::cos(angle), out * std::sin(angle), height_m * lerp(0.5F, 0.86F, up)};
    Model branch;
    const std::uint32_t leaves = random.bits();
    branch.addEllipsoid(Material::kFoliage, {}, {size, size, 0.75F * size}, tone * random.uniform(0.8F, 1.3F), leaves);
    const Wind wind{static_cast<double>(lerp(kLowest_m, kHighest_m, up)), towards_rad, gust_rad,
                    random.uniform(0, 6.28F)};
    m.addLimb(std::move(branch), [wind, rest](double t_s) { return wind.at(t_s, rest); });
  }
  return m;
}

Model makeCottage(float length_m, float depth_m, std::uint32_t seed) {
  constexpr float kEaves_m = 2.7F, kOverhang_m = 0.45F;
  Model m;
  Random random(seed);
  const float x = 0.5F * length_m, y = 0.5F * depth_m;
  const float shutters = random.chance(0.5F) ? random.uniform(0.1F, 0.2F) : random.uniform(0.4F, 0.6F);
  m.add(Material::kConcrete, {-x, -y, 0}, {x, y, kEaves_m + 0.2F}, random.uniform(0.4F, 0.6F), seed);
  addWindows(m, 1, length_m, y, shutters);
  addWindows(m, 0, depth_m, x, shutters);
  addHippedRoof(m, {x + kOverhang_m, y + kOverhang_m, kEaves_m}, random.uniform(0.16F, 0.3F), seed + 1);
  for (const float side : {-1.0F, 1.0F}) {  // gutters
    const float edge = side * (y + kOverhang_m);
    m.addCylinder(Material::kMetal, 0, {-x - kOverhang_m, edge - 0.06F, kEaves_m - 0.07F},
                  {x + kOverhang_m, edge + 0.06F, kEaves_m + 0.05F}, 0.3F, seed + 2);
  }
  m.add(Material::kBrickwork, {0.4F * x, 0.2F, kEaves_m}, {0.4F * x + 0.6F, 1.0F, kEaves_m + 4}, 0.2F, seed + 3);
  return m;
}

Model makeTerrace(float length_m, float depth_m, float height_m, float tone) {
  constexpr float kBay_m = 4;
  Model m;
  const float x = 0.5F * length_m, y = 0.5F * depth_m;
  m.add(Material::kBrickwork, {-x, -y, 0}, {x, y, height_m}, tone, 1);
  m.add(Material::kConcrete, {-x, -y - 0.2F, height_m - 0.3F}, {x, y + 0.2F, height_m + 0.1F}, 0.42F, 2);
  for (const float side : {-1.0F, 1.0F}) {
    Wall wall(m, 1, side, y);
    for (float at = -x + 0.5F * kBay_m; at < x; at += kBay_m) addTerraceBay(wall, at, height_m, tone);
  }
  return m;
}

}  // namespace motorcade::synth
