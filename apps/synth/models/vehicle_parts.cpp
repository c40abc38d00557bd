#include "apps/synth/models/vehicle_parts.hpp"

namespace motorcade::synth {

void addWheels(Model& model, const Shape3& s, float radius, std::initializer_list<float> axles) {
  const float rim = lerp(0.35F, 0.7F, unit(mix(s.seed + 11)));
  for (const float x : axles)
    for (const float y : {-1.0F, 1.0F}) {
      const float outer = y * s.side(), inner = y * (s.side() - 0.21F);
      model.addCylinder(Material::kTire, 1, {x - radius, std::min(outer, inner), 0},
                        {x + radius, std::max(outer, inner), 2 * radius}, rim, s.seed);
    }
}

void addPair(Model& model, Material material, const Vec3& lo, const Vec3& hi, float tone, std::uint32_t seed) {
  model.add(material, lo, hi, tone, seed);
  model.add(material, {lo.x, -hi.y, lo.z}, {hi.x, -lo.y, hi.z}, tone, seed);
}

void addFront(Model& m, const Shape3& s, float lamp_z) {
  const float x = s.front(), y = s.side();
  m.add(Material::kPlastic, {x - 0.25F, -y + 0.10F, 0.26F}, {x, y - 0.10F, 0.46F},
        unit(mix(s.seed)) < 0.5F ? 0.07F : 0.8F * s.paint, s.seed);
  m.cutLast({1, 0.7F, 0}, {x, y - 0.32F, 0});
  m.cutLast({1, -0.7F, 0}, {x, -y + 0.32F, 0});
  addPair(m, Material::kHeadLamp, {x - 0.30F, y - 0.50F, lamp_z}, {x - 0.03F, y - 0.07F, lamp_z + 0.17F}, 0.6F, s.seed);
  m.add(Material::kGrille, {x - 0.2F, -0.38F, lamp_z - 0.02F}, {x - 0.025F, 0.38F, lamp_z + 0.15F}, 0.2F, s.seed);
  m.addEllipsoid(Material::kChrome, {x - 0.02F, 0, lamp_z + 0.11F}, {0.02F, 0.06F, 0.05F}, 0.6F);
  m.add(Material::kPlate, {x - 0.02F, -0.26F, 0.33F}, {x + 0.005F, 0.26F, 0.44F}, 0.8F, s.seed);
  addPair(m, Material::kGlass, {x - 0.12F, y - 0.42F, 0.31F}, {x + 0.0F, y - 0.26F, 0.40F}, 0.4F, s.seed);
}

void addRear(Model& m, const Shape3& s, float lamp_z, float lamp_height) {
  const float x = -s.front(), y = s.side();
  m.add(Material::kPlastic, {x, -y + 0.06F, 0.30F}, {x + 0.25F, y - 0.06F, 0.52F},
        unit(mix(s.seed + 1)) < 0.4F ? 0.08F : 0.75F * s.paint, s.seed + 2);
  m.cutLast({-1, 0.7F, 0}, {x, y - 0.22F, 0});
  m.cutLast({-1, -0.7F, 0}, {x, -y + 0.22F, 0});
  addPair(m, Material::kTailLamp, {x + 0.03F, y - 0.42F, lamp_z}, {x + 0.35F, y - 0.04F, lamp_z + lamp_height}, 0.15F,
          s.seed);
  const float plate_z = (s.seed & 8U) != 0 ? 0.36F : 0.64F;
  m.add(Material::kPlate, {x - 0.004F, -0.26F, plate_z}, {x + 0.05F, 0.26F, plate_z + 0.115F}, 0.8F, s.seed + 1);
  m.add(Material::kChrome, {x + 0.035F, -0.32F, plate_z + 0.15F}, {x + 0.08F, 0.32F, plate_z + 0.185F}, 0.6F);
  m.addEllipsoid(Material::kChrome, {x + 0.05F, 0, plate_z + 0.26F}, {0.022F, 0.055F, 0.055F}, 0.6F);
  m.addCylinder(Material::kChrome, 0, {x - 0.03F, -y + 0.32F, 0.22F}, {x + 0.3F, -y + 0.40F, 0.30F}, 0.3F);
  addPair(m, Material::kTailLamp, {x - 0.006F, y - 0.40F, 0.36F}, {x + 0.02F, y - 0.24F, 0.41F}, 0.15F, s.seed);
  // The model's name.
  m.add(Material::kPlate, {x + 0.036F, 0.33F, plate_z + 0.21F}, {x + 0.08F, 0.60F, plate_z + 0.27F}, 0.6F, s.seed + 5);
}

}  // namespace motorcade::synth
