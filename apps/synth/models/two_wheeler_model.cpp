#include "apps/synth/models/two_wheeler_model.hpp"

#include <numbers>

#include "apps/synth/models/body_parts.hpp"
#include "apps/synth/models/model_size.hpp"

namespace motorcade::synth {
namespace {

/// A city bicycle [m]: wheels of 28 inches, cranks of 17 cm.
constexpr float kWheel_m = 0.345F, kRear_m = -0.53F, kFront_m = 0.54F, kCrank_m = 0.17F, kPedalSide_m = 0.13F;
constexpr Vec3 kBottomBracket{-0.09F, 0, 0.29F}, kHead{0.36F, 0, 0.86F};
constexpr double kDevelopment_m = 4.8;  // way of one turn of the cranks
constexpr double kLean_rad = 0.48;      // of the rider's trunk

double crankAngle_rad(double driven_m) { return 2 * std::numbers::pi * driven_m / kDevelopment_m; }

Vec3 pedalAt(double driven_m, bool left) {
  const double angle = crankAngle_rad(driven_m) + (left ? 0 : std::numbers::pi);
  return kBottomBracket + Vec3{kCrank_m * static_cast<float>(std::sin(angle)), left ? kPedalSide_m : -kPedalSide_m,
                               kCrank_m * static_cast<float>(std::cos(angle))};
}

/// The hips above the saddle, whose height nearly stretches the leg at the lowest pedal.
Vec3 hipOf(const Body& b) {
  const float up = 0.965F * (b.thigh() + b.shin()) + b.foot() - kCrank_m;
  return {kBottomBracket.x - 0.15F, 0, kBottomBracket.z + up};
}

Model makeWheel(std::uint32_t seed) {
  Model m;
  const float r = kWheel_m;
  m.addCylinder(Material::kPlastic, 1, {-r, -0.02F, -r}, {r, 0.02F, r}, 0.04F, seed).hole = 0.90F;
  m.addCylinder(Material::kChrome, 1, {-0.92F * r, -0.012F, -0.92F * r}, {0.92F * r, 0.012F, 0.92F * r}, 0.5F, seed)
      .hole = 0.86F;
  m.addCylinder(Material::kChrome, 1, {-0.03F, -0.05F, -0.03F}, {0.03F, 0.05F, 0.03F}, 0.5F, seed);
  // Reflectors between the spokes; a spoke itself is far thinner than a pixel.
  for (const float side : {-1.0F, 1.0F})
    m.add(Material::kPlate, {-0.05F, -0.008F, 0.62F * side * r - 0.02F}, {0.05F, 0.008F, 0.62F * side * r + 0.02F},
          0.8F, seed);
  return m;
}

Model makeCranks() {
  Model m;
  m.addCylinder(Material::kChrome, 1, {-0.09F, -0.055F, -0.09F}, {0.09F, -0.045F, 0.09F}, 0.4F);
  for (const float side : {-1.0F, 1.0F}) {
    const float y = side * 0.08F;
    m.add(Material::kChrome, {-0.013F, y - 0.01F, std::min(0.0F, side * kCrank_m)},
          {0.013F, y + 0.01F, std::max(0.0F, side * kCrank_m)}, 0.5F);
    m.add(Material::kPlastic, {-0.04F, side * kPedalSide_m - 0.045F, side * kCrank_m - 0.012F},
          {0.04F, side * kPedalSide_m + 0.045F, side * kCrank_m + 0.012F}, 0.04F);
  }
  return m;
}

void addBicycle(Model& m, const Vec3& saddle, float paint, std::uint32_t seed) {
  const Vec3 rear{kRear_m, 0, kWheel_m}, front{kFront_m, 0, kWheel_m}, top{saddle.x + 0.02F, 0, saddle.z - 0.14F};
  const Vec3 steering = kHead + Vec3{0, 0, -0.12F}, seat_lug = kBottomBracket + (top - kBottomBracket) * 0.75F;
  m.addBar(Material::kPaint, kBottomBracket, seat_lug, 0.036F, paint);
  m.addBar(Material::kChrome, seat_lug, top, 0.028F, 0.5F);
  m.addBar(Material::kPaint, kBottomBracket, steering, 0.042F, paint);
  m.addBar(Material::kPaint, seat_lug, kHead, 0.034F, paint);
  m.addBar(Material::kPaint, front, kHead, 0.036F, paint);
  m.addBar(Material::kPaint, kBottomBracket, rear, 0.024F, paint);
  m.addBar(Material::kPaint, seat_lug, rear, 0.022F, paint);
  m.addBar(Material::kChrome, kHead, kHead + Vec3{-0.03F, 0, 0.16F}, 0.028F, 0.4F);
  m.add(Material::kChrome, {0.30F, -0.29F, 1.01F}, {0.33F, 0.29F, 1.035F}, 0.4F);
  for (const float side : {-1.0F, 1.0F})
    m.add(Material::kPlastic, {0.20F, side * 0.275F - 0.018F, 1.0F}, {0.335F, side * 0.275F + 0.018F, 1.04F}, 0.04F);
  m.add(Material::kPlastic, {top.x - 0.15F, -0.075F, top.z}, {top.x + 0.12F, 0.075F, top.z + 0.06F}, 0.04F);
  m.cutLast({0.35F, 1, 0}, {top.x, 0.065F, 0});
  m.cutLast({0.35F, -1, 0}, {top.x, -0.065F, 0});
  // Mudguard, rack and lamps.
  m.add(Material::kPlastic, {kRear_m - 0.16F, -0.03F, 0.715F}, {kRear_m + 0.2F, 0.03F, 0.73F}, 0.05F);
  m.add(Material::kMetal, {kRear_m - 0.18F, -0.06F, 0.76F}, {kRear_m + 0.2F, 0.06F, 0.775F}, 0.3F, seed);
  m.addBar(Material::kMetal, {kRear_m - 0.1F, 0, 0.76F}, rear, 0.02F, 0.3F);
  m.add(Material::kTailLamp, {kRear_m - 0.2F, -0.035F, 0.66F}, {kRear_m - 0.16F, 0.035F, 0.74F}, 0.2F, seed);
  m.add(Material::kHeadLamp, {0.42F, -0.03F, 0.82F}, {0.47F, 0.03F, 0.9F}, 0.6F, seed);
}

void addRider(Model& m, const Body& b, const Vec3& hip, bool helmet) {
  constexpr Vec3 kGrip{0.24F, 0, 1.05F};
  Model trunk = makeTrunk(b);
  trunk.addLimb(makeHead(b, helmet), [b](double) { return Limb::Pose{{0, 0, b.neck()}, -0.75 * kLean_rad}; });
  if ((b.seed & 3U) == 0) trunk.add(Material::kCloth, {-0.23F, -0.14F, 0.1F}, {-0.09F, 0.14F, 0.46F}, 0.4F, b.seed + 7);
  m.addLimb(std::move(trunk), [hip](double) { return Limb::Pose{hip, kLean_rad}; });
  const float sine = static_cast<float>(std::sin(kLean_rad)), cosine = static_cast<float>(std::cos(kLean_rad));
  for (const bool left : {true, false}) {
    const float side = left ? 1.0F : -1.0F;
    const Vec3 shoulder = hip + Vec3{b.shoulder() * sine, side * b.shoulderSide(), b.shoulder() * cosine};
    const Pose arm = reaching(shoulder, kGrip, b.upperArm(), b.forearm() + 0.04F * b.height, true);
    addArm(m, b, [arm](double) { return arm; });
    addLeg(m, b, [b, hip, left, side](double driven_m) {
      const Vec3 ankle = pedalAt(driven_m, left) + Vec3{-0.5F * b.toe(), 0, b.foot() + 0.012F};
      Pose leg = reaching(hip + Vec3{0, side * b.hipSide() * 1.4F, 0}, ankle, b.thigh(), b.shin(), false);
      leg.toes_down_rad = leg.raised_rad - leg.bent_rad;  // level
      return leg;
    });
  }
}

}  // namespace

Model makeCyclist(std::uint32_t seed) {
  Random random(seed + 300);
  const Body body = makeBody(seed);
  const Vec3 hip = hipOf(body);
  Model m;
  addBicycle(m, hip, random.chance(0.6F) ? 0.06F : random.uniform(0.15F, 0.7F), seed);
  for (const float axle : {kRear_m, kFront_m})
    m.addLimb(makeWheel(seed), [axle](double driven_m) {
      return Limb::Pose{{axle, 0, kWheel_m}, driven_m / static_cast<double>(kWheel_m)};
    });
  m.addLimb(makeCranks(), [](double driven_m) { return Limb::Pose{kBottomBracket, crankAngle_rad(driven_m)}; });
  addRider(m, body, hip, random.chance(0.5F));
  m.kitti_type = "Cyclist";
  fitBox(m, kDevelopment_m);
  return m;
}

}  // namespace motorcade::synth
