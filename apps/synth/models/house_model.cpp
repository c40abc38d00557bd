#include "apps/synth/models/house_model.hpp"

namespace motorcade::synth {
namespace {

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
