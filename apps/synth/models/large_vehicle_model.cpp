#include "apps/synth/models/large_vehicle_model.hpp"

#include "apps/synth/models/model_size.hpp"
#include "apps/synth/models/vehicle_parts.hpp"

namespace motorcade::synth {

Model makeBus(std::uint32_t seed) {
  Random random(seed + 400);
  constexpr float kLiveries[] = {0.08F, 0.2F, 0.45F, 0.68F};
  const Shape3 s{random.uniform(11.4F, 12.1F), 2.55F, random.uniform(2.95F, 3.1F), kLiveries[random.bits() % 4], seed};
  const float x = s.front(), y = s.side() - 0.03F;
  Model m;
  m.add(Material::kCoach, {-x + 0.04F, -y, 0.32F}, {x - 0.04F, y, s.height}, s.paint, seed);
  m.cutLast({1, 0, 0.07F}, {x - 0.04F, 0, 1.1F});
  for (const float side : {-1.0F, 1.0F}) {
    m.cutLast({0, side, 0.8F}, {0, side * y, s.height - 0.16F});
    m.cutLast({1, 0.35F * side, 0}, {x - 0.04F, side * (y - 0.30F), 0});
  }
  m.add(Material::kPlastic, {-x + 0.3F, -y + 0.1F, 0.2F}, {x - 0.3F, y - 0.1F, 0.4F}, 0.03F, seed);
  m.add(Material::kPlastic, {-0.25F * s.length, -0.85F, s.height - 0.02F}, {0.1F * s.length, 0.85F, s.height + 0.2F},
        0.5F, seed + 1);
  m.cutLast({1, 0, 1}, {0.1F * s.length, 0, s.height + 0.05F});
  addFront(m, s, 0.62F);
  addRear(m, s, 0.8F, 0.5F);
  addPair(m, Material::kPlastic, {x - 0.05F, y - 0.12F, 2.05F}, {x + 0.12F, y + 0.14F, 2.5F}, 0.04F, seed);
  addPair(m, Material::kPlastic, {x - 0.1F, y - 0.14F, 2.5F}, {x + 0.1F, y + 0.02F, 2.55F}, 0.04F, seed);
  addWheels(m, s, 0.48F, {-0.24F * s.length, 0.27F * s.length});
  m.kitti_type = "Bus";
  fitBox(m);
  return m;
}

Model makeTrailer(std::uint32_t seed) {
  Random random(seed + 500);
  constexpr float kDrawbar_m = 1.0F, kFloor_m = 0.98F;
  const Shape3 s{kDrawbar_m + random.uniform(6.2F, 7.2F), random.uniform(2.44F, 2.52F), random.uniform(3.3F, 3.7F),
                 random.chance(0.5F) ? random.uniform(0.45F, 0.7F) : random.uniform(0.06F, 0.25F), seed};
  const float x = s.front(), y = s.side() - 0.03F, box_front = x - kDrawbar_m, middle = 0.5F * (box_front - x);
  Model m;
  m.add(Material::kCargo, {-x + 0.05F, -y, kFloor_m}, {box_front, y, s.height}, s.paint, seed);
  m.add(Material::kPlastic, {-x + 0.15F, -0.5F, 0.62F}, {box_front - 0.1F, 0.5F, kFloor_m}, 0.05F, seed);
  m.add(Material::kPlastic, {box_front - 0.3F, -0.08F, 0.52F}, {x, 0.08F, 0.68F}, 0.05F, seed);
  addRear(m, s, 0.64F, 0.16F);
  addPair(m, Material::kGrille, {middle + 1.4F, y - 0.05F, 0.45F}, {box_front - 0.4F, y, 0.9F}, 0.2F, seed);
  addPair(m, Material::kGrille, {-x + 0.5F, y - 0.05F, 0.45F}, {middle - 1.4F, y, 0.9F}, 0.2F, seed);
  addPair(m, Material::kSign, {-x + 0.02F, y - 0.55F, 1.05F}, {-x + 0.04F, y - 0.05F, 1.2F}, 0.7F, seed + 3);
  addWheels(m, s, 0.45F, {middle - 0.62F, middle + 0.62F});
  m.kitti_type = "Trailer";
  fitBox(m);
  return m;
}

}  // namespace motorcade::synth
