#include <initializer_list>

#include "apps/synth/models/models.hpp"
#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Parts that vehicles of all kinds have.
namespace motorcade::synth {
namespace {

/// Measures and colors shared by a vehicle's parts.
struct Shape3 {
  float length, width, height;
  float paint;
  std::uint32_t seed;
  float front() const { return 0.5F * length; }
  float side() const { return 0.5F * width; }
};

/// A pair of wheels on each axle.
void addWheels(Model& model, const Shape3& s, float radius, std::initializer_list<float> axles) {
  const float rim = lerp(0.35F, 0.7F, unit(mix(s.seed + 11)));
  for (const float x : axles)
    for (const float y : {-1.0F, 1.0F}) {
      const float outer = y * s.side(), inner = y * (s.side() - 0.21F);
      model.addCylinder(Material::kTire, 1, {x - radius, std::min(outer, inner), 0},
                        {x + radius, std::max(outer, inner), 2 * radius}, rim, s.seed);
    }
}

/// A part and its mirror image across the vehicle's middle plane.
void addPair(Model& model, Material material, const Vec3& lo, const Vec3& hi, float tone, std::uint32_t seed) {
  model.add(material, lo, hi, tone, seed);
  model.add(material, {lo.x, -hi.y, lo.z}, {hi.x, -lo.y, hi.z}, tone, seed);
}

/// Bumper, lamps, grille and plate.
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

void addSides(Model& m, const Shape3& s, float mirror_x, float belt_z) {
  const float y = s.side() - 0.03F;
  addPair(m, Material::kPaint, {mirror_x - 0.10F, y - 0.02F, belt_z + 0.03F},
          {mirror_x + 0.08F, y + 0.16F, belt_z + 0.17F}, 0.8F * s.paint, s.seed + 3);
  for (const float x : {-0.17F * s.length, 0.06F * s.length})
    addPair(m, Material::kChrome, {x, y, belt_z - 0.11F}, {x + 0.17F, y + 0.025F, belt_z - 0.07F}, 0.4F, s.seed);
  addPair(m, Material::kPlastic, {-0.27F * s.length, y, 0.24F}, {0.26F * s.length, y + 0.022F, 0.33F}, 0.06F, s.seed);
}

Model makeCar(const Shape3& s) {
  Model m;
  Random random(s.seed + 100);
  const float x = s.front(), y = s.side() - 0.03F;
  const float belt = random.uniform(0.86F, 0.94F), bonnet = random.uniform(1.15F, 1.4F);
  const bool estate = random.chance(0.5F);
  m.add(Material::kPaint, {-x + 0.04F, -y, 0.25F}, {x - 0.04F, y, belt + 0.02F}, s.paint, s.seed);
  m.cutLast({0.16F, 0, 1}, {x - bonnet, 0, belt + 0.02F});
  m.cutLast({1, 0.55F, 0}, {x - 0.04F, y - 0.20F, 0});
  m.cutLast({1, -0.55F, 0}, {x - 0.04F, -y + 0.20F, 0});
  m.cutLast({-1, 0.5F, 0}, {-x + 0.04F, y - 0.14F, 0});
  m.cutLast({-1, -0.5F, 0}, {-x + 0.04F, -y + 0.14F, 0});
  m.add(Material::kPlastic, {-x + 0.2F, -y + 0.08F, 0.15F}, {x - 0.2F, y - 0.08F, 0.3F}, 0.03F, s.seed);
  const float back = estate ? -x + 0.12F : -x + 0.62F;
  m.add(Material::kCabin, {back, -y + 0.03F, belt}, {x - bonnet + 0.1F, y - 0.03F, s.height}, s.paint, s.seed);
  m.cutLast({0.62F, 0, 0.78F}, {x - bonnet + 0.1F, 0, belt + 0.02F});
  m.cutLast({-(estate ? 0.93F : 0.72F), 0, estate ? 0.36F : 0.69F}, {back, 0, belt + 0.02F});
  m.cutLast({0, 1, 0.30F}, {0, y - 0.03F, belt + 0.05F});
  m.cutLast({0, -1, 0.30F}, {0, -y + 0.03F, belt + 0.05F});
  addFront(m, s, 0.58F);
  addRear(m, s, estate ? 0.70F : 0.66F, estate ? 0.24F : 0.16F);
  addSides(m, s, x - bonnet - 0.25F, belt);
  addWheels(m, s, 0.32F, {-0.30F * s.length, 0.31F * s.length});
  m.add(Material::kTailLamp, {back + (estate ? 0.19F : 0.35F), -0.16F, s.height - 0.10F},
        {back + 0.5F, 0.16F, s.height - 0.06F}, 0.15F, s.seed);
  if (estate)
    addPair(m, Material::kChrome, {back + 0.35F, y - 0.28F, s.height - 0.01F}, {0.3F, y - 0.24F, s.height + 0.045F},
            0.4F, s.seed);
  if (random.chance(0.5F))
    m.addCylinder(Material::kPlastic, 2, {back + 0.8F, -0.012F, s.height - 0.02F},
                  {back + 0.824F, 0.012F, s.height + 0.22F}, 0.03F);
  const bool has_sticker = random.chance(0.6F);
  if (has_sticker)
    m.add(Material::kSign, {-x + 0.034F, -0.66F, belt - 0.20F}, {-x + 0.06F, -0.44F, belt - 0.06F}, 0.75F, s.seed + 4);
  return m;
}

Model makeVan(const Shape3& s) {
  Model m;
  const float x = s.front(), y = s.side() - 0.03F;
  const float inner = y - 0.008F;  // within the panels below: no two faces in one plane
  m.add(Material::kCargo, {-x + 0.05F, -inner, 0.55F}, {x - 1.75F, inner, s.height}, s.paint, s.seed);
  m.cutLast({0, 1, 0.35F}, {0, inner, s.height - 0.25F});
  m.cutLast({0, -1, 0.35F}, {0, -inner, s.height - 0.25F});
  m.add(Material::kPaint, {-x + 0.04F, -y, 0.28F}, {x - 0.04F, y, 1.05F}, s.paint, s.seed);
  m.cutLast({0.25F, 0, 1}, {x - 0.75F, 0, 1.05F});
  m.add(Material::kCabin, {x - 1.80F, -y + 0.02F, 1.04F}, {x - 0.55F, y - 0.02F, s.height - 0.05F}, s.paint, s.seed);
  m.cutLast({0.80F, 0, 0.60F}, {x - 0.55F, 0, 1.10F});
  addFront(m, s, 0.66F);
  addRear(m, s, 0.75F, 0.42F);
  addPair(m, Material::kGlass, {-x + 0.03F, 0.10F, s.height - 0.85F}, {-x + 0.06F, y - 0.22F, s.height - 0.30F}, 0.05F,
          s.seed);
  addPair(m, Material::kPlastic, {x - 1.05F, y - 0.02F, 1.10F}, {x - 0.90F, y + 0.20F, 1.42F}, 0.05F, s.seed);
  addPair(m, Material::kPlastic, {-0.3F * s.length, y, 0.40F}, {0.2F * s.length, y + 0.022F, 0.52F}, 0.06F, s.seed);
  addWheels(m, s, 0.35F, {-0.30F * s.length, 0.32F * s.length});
  m.add(Material::kChrome, {-x + 0.02F, -0.05F, 0.9F}, {-x + 0.06F, 0.05F, 1.02F}, 0.5F);
  return m;
}

Model makeTruck(const Shape3& s) {
  Model m;
  const float x = s.front(), y = s.side() - 0.03F;
  m.add(Material::kCargo, {-x + 0.05F, -y, 1.0F}, {x - 2.0F, y, s.height}, s.paint, s.seed);
  m.add(Material::kPlastic, {-x + 0.15F, -0.45F, 0.55F}, {x - 0.4F, 0.45F, 1.0F}, 0.06F, s.seed);
  m.add(Material::kPaint, {x - 1.85F, -y + 0.06F, 0.42F}, {x - 0.02F, y - 0.06F, 1.5F}, 0.6F, s.seed + 1);
  m.add(Material::kCabin, {x - 1.85F, -y + 0.06F, 1.5F}, {x - 0.02F, y - 0.06F, std::min(2.85F, s.height - 0.1F)}, 0.6F,
        s.seed + 1);
  m.cutLast({0.97F, 0, 0.2F}, {x - 0.02F, 0, 1.6F});
  addFront(m, s, 0.62F);
  addRear(m, s, 0.60F, 0.16F);
  addPair(m, Material::kGrille, {-0.25F * s.length, y - 0.05F, 0.42F}, {0.12F * s.length, y, 0.92F}, 0.2F, s.seed);
  addPair(m, Material::kSign, {-x + 0.02F, y - 0.55F, 1.05F}, {-x + 0.04F, y - 0.05F, 1.2F}, 0.7F, s.seed + 3);
  m.add(Material::kSign, {-x + 0.02F, -0.9F, 0.66F}, {-x + 0.06F, -0.3F, 0.95F}, 0.75F, s.seed + 4);
  addPair(m, Material::kPlastic, {x - 0.3F, y - 0.04F, 1.7F}, {x - 0.15F, y + 0.03F, 2.3F}, 0.05F, s.seed);
  addWheels(m, s, 0.47F, {-0.36F * s.length, -0.22F * s.length, 0.5F * s.length - 1.2F});
  return m;
}

float toneOf(Finish finish, Random& random) {
  constexpr float kPaints[] = {0.03F, 0.05F, 0.10F, 0.16F, 0.24F, 0.34F, 0.48F, 0.62F, 0.72F};
  const float any = kPaints[random.bits() % 9];
  switch (finish) {
    case Finish::kDark:
    case Finish::kSmoothDark:
      return 0.022F;
    case Finish::kSmoothLight:
      return 0.55F + 0.3F * any;
    case Finish::kAny:
      break;
  }
  return any;
}

}  // namespace

Model makeVehicle(VehicleKind kind, std::uint32_t seed, Finish finish) {
  Random random(seed);
  const float paint = toneOf(finish, random);
  Model model;
  switch (kind) {
    case VehicleKind::kCar:
      model = makeCar(
          {random.uniform(4.0F, 4.6F), random.uniform(1.70F, 1.84F), random.uniform(1.42F, 1.56F), paint, seed});
      model.kitti_type = "Car";
      break;
    case VehicleKind::kVan:
      model =
          makeVan({random.uniform(4.9F, 5.6F), random.uniform(1.90F, 2.02F), random.uniform(2.0F, 2.4F), paint, seed});
      model.kitti_type = "Van";
      break;
    case VehicleKind::kTruck:
      model = makeTruck(
          {random.uniform(7.5F, 9.0F), random.uniform(2.40F, 2.52F), random.uniform(3.4F, 3.8F), paint, seed});
      model.kitti_type = "Truck";
      break;
  }
  model.smooth_paint = finish == Finish::kSmoothDark || finish == Finish::kSmoothLight;
  fitBox(model);
  return model;
}

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
