#include "apps/synth/models/body_parts.hpp"

#include <numbers>

namespace motorcade::synth {
namespace {

/// A round segment that hangs from the origin: a tube of cloth or skin with a ball at each joint.
Model makeSegment(Material material, float length, float top, float bottom, float tone, std::uint32_t seed) {
  Model m;
  const float middle = 0.5F * (top + bottom), low = 1.02F * bottom;
  m.addEllipsoid(material, {0, 0, -0.25F * length}, {top, top, 0.36F * length}, tone, seed);
  m.addCylinder(material, 2, {-middle, -middle, -0.62F * length}, {middle, middle, -0.2F * length}, tone, seed);
  m.addCylinder(material, 2, {-low, -low, -length}, {low, low, -0.55F * length}, tone, seed);
  return m;
}

Model makeFoot(const Body& b) {
  Model m;
  const float half = 0.026F * b.height;
  m.add(Material::kCloth, {b.heel(), -half, -b.foot()}, {b.toe(), half, 0.25F * b.foot()}, b.shoes, b.seed + 3);
  m.cutLast({0.5F, 0, 1}, {0.4F * b.toe(), 0, 0.1F * b.foot()});
  m.cutLast({1, 0.9F, 0}, {b.toe(), 0.4F * half, 0});
  m.cutLast({1, -0.9F, 0}, {b.toe(), -0.4F * half, 0});
  return m;
}

}  // namespace

Body makeBody(std::uint32_t seed) {
  Random random(seed);
  constexpr float kShirts[] = {0.04F, 0.09F, 0.17F, 0.28F, 0.45F, 0.66F};
  constexpr float kTrousers[] = {0.035F, 0.06F, 0.11F, 0.2F, 0.34F};
  Body body;
  body.height = random.uniform(1.58F, 1.88F);
  body.shirt = kShirts[random.bits() % 6];
  body.trousers = kTrousers[random.bits() % 5];
  body.shoes = random.chance(0.3F) ? 0.6F : 0.05F;
  body.skin = random.uniform(0.16F, 0.42F);
  body.hair = random.uniform(0.025F, 0.2F);
  body.seed = random.bits() & ~1U;  // even: patterns are for shirts, whose parts carry this seed
  return body;
}

Model makeTrunk(const Body& b) {
  Model m;
  const float h = b.height;
  const auto cloth = [&](float from, float to, float deep, float wide) {
    m.addCylinder(Material::kCloth, 2, {-deep * h, -wide * h, from * h}, {deep * h, wide * h, to * h}, b.shirt, b.seed);
  };
  m.addEllipsoid(Material::kCloth, {-0.008F * h, 0, -0.015F * h}, {0.070F * h, 0.101F * h, 0.085F * h}, b.trousers,
                 b.seed + 1);
  m.addCylinder(Material::kCloth, 2, {-0.062F * h, -0.092F * h, 0}, {0.060F * h, 0.092F * h, 0.05F * h}, b.trousers,
                b.seed + 1);
  cloth(0.03F, 0.14F, 0.060F, 0.088F);
  cloth(0.12F, 0.25F, 0.066F, 0.100F);
  m.addEllipsoid(Material::kCloth, {0, 0, 0.19F * h}, {0.072F * h, 0.112F * h, 0.125F * h}, b.shirt, b.seed);
  m.addEllipsoid(Material::kCloth, {-0.004F * h, 0, 0.278F * h}, {0.050F * h, 0.135F * h, 0.036F * h}, b.shirt, b.seed);
  m.addCylinder(Material::kSkin, 2, {-0.030F * h, -0.030F * h, 0.28F * h}, {0.030F * h, 0.030F * h, 0.36F * h}, b.skin,
                b.seed + 2);
  return m;
}

Model makeHead(const Body& b, bool helmet) {
  Model m;
  const float h = b.height;
  m.addEllipsoid(Material::kSkin, {0.008F * h, 0, 0.062F * h}, {0.050F * h, 0.042F * h, 0.064F * h}, b.skin,
                 b.seed + 2);
  m.addEllipsoid(Material::kSkin, {0.056F * h, 0, 0.056F * h}, {0.012F * h, 0.009F * h, 0.013F * h}, b.skin,
                 b.seed + 2);
  const float cap = helmet ? 1.16F : 1.0F, tone = helmet ? b.shirt : b.hair;
  m.addEllipsoid(helmet ? Material::kPlastic : Material::kCloth, {-0.006F * h, 0, (helmet ? 0.088F : 0.080F) * h},
                 {0.052F * cap * h, 0.045F * cap * h, 0.052F * h}, tone, b.seed + 4);
  return m;
}

void addLeg(Model& model, const Body& b, const PoseAt& pose) {
  const float h = b.height;
  Model shin = makeSegment(Material::kCloth, b.shin(), 0.036F * h, 0.026F * h, b.trousers, b.seed + 1);
  shin.addLimb(makeFoot(b), [b, pose](double driven_m) {
    return Limb::Pose{{0, 0, -b.shin()}, pose(driven_m).toes_down_rad};
  });
  Model thigh = makeSegment(Material::kCloth, b.thigh(), 0.052F * h, 0.038F * h, b.trousers, b.seed + 1);
  thigh.addLimb(std::move(shin), [b, pose](double driven_m) {
    return Limb::Pose{{0, 0, -b.thigh()}, pose(driven_m).bent_rad};
  });
  model.addLimb(std::move(thigh), [pose](double driven_m) {
    const Pose at = pose(driven_m);
    return Limb::Pose{at.joint, -at.raised_rad};
  });
}

void addArm(Model& model, const Body& b, const PoseAt& pose) {
  const float h = b.height;
  const bool sleeves = (b.seed & 64U) != 0;
  Model forearm = makeSegment(sleeves ? Material::kCloth : Material::kSkin, b.forearm(), 0.024F * h, 0.018F * h,
                              sleeves ? b.shirt : b.skin, b.seed);
  forearm.addEllipsoid(Material::kSkin, {0.004F * h, 0, -b.forearm() - 0.035F * h},
                       {0.021F * h, 0.014F * h, 0.045F * h}, b.skin, b.seed + 2);
  Model upper = makeSegment(Material::kCloth, b.upperArm(), 0.034F * h, 0.025F * h, b.shirt, b.seed);
  upper.addLimb(std::move(forearm), [b, pose](double driven_m) {
    return Limb::Pose{{0, 0, -b.upperArm()}, -pose(driven_m).bent_rad};
  });
  model.addLimb(std::move(upper), [pose](double driven_m) {
    const Pose at = pose(driven_m);
    return Limb::Pose{at.joint, -at.raised_rad};
  });
}

Pose reaching(const Vec3& joint, const Vec3& end, float first_m, float second_m, bool arm) {
  const double x = static_cast<double>(end.x - joint.x), z = static_cast<double>(end.z - joint.z);
  const double a = static_cast<double>(first_m), b = static_cast<double>(second_m);
  const double far = std::clamp(std::hypot(x, z), std::abs(a - b) + 1e-3, a + b - 1e-3);
  const double at_joint = std::acos((a * a + far * far - b * b) / (2 * a * far));
  const double at_middle = std::acos((a * a + b * b - far * far) / (2 * a * b));
  return {joint, std::atan2(x, -z) + (arm ? -at_joint : at_joint), std::numbers::pi - at_middle};
}

}  // namespace motorcade::synth
