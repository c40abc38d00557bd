#include <numbers>

#include "apps/synth/models/models.hpp"
#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Parts of people, on foot and on a bicycle.
namespace motorcade::synth {
namespace {

/// A person's size and clothes. Lengths of the segments are shares of the height: Drillis and Contini, "Body segment
/// parameters", 1966.
struct Body {
  float height = 1.75F;
  float shirt = 0.3F, trousers = 0.1F, shoes = 0.05F, skin = 0.3F, hair = 0.05F;
  std::uint32_t seed = 0;

  float thigh() const { return 0.245F * height; }
  float shin() const { return 0.246F * height; }
  float foot() const { return 0.039F * height; }  // sole to ankle
  float heel() const { return -0.040F * height; }
  float toe() const { return 0.112F * height; }
  float upperArm() const { return 0.186F * height; }
  float forearm() const { return 0.146F * height; }
  float hipSide() const { return 0.052F * height; }
  float shoulderSide() const { return 0.130F * height; }
  float shoulder() const { return 0.288F * height; }  // above the hips
  float neck() const { return 0.335F * height; }
};

/// Angles of a leg or an arm. `raised_rad` turns the first segment ahead from hanging down. `bent_rad` turns the second
/// one back against the first, or ahead for an arm. `toes_down_rad` turns a foot's toes down against the shin.
struct Pose {
  Vec3 joint;  // hip or shoulder
  double raised_rad = 0, bent_rad = 0, toes_down_rad = 0;
};

using PoseAt = std::function<Pose(double driven_m)>;

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

/// The body from the hips up to the neck; arms and head are its limbs.
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

/// Origin at the neck.
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

/// Raises and bends two segments so that the end of the second one, which starts at `joint`, is at `end`; stretches
/// them when it is too far. The middle joint is ahead of the line for a leg, behind it for an arm.
Pose reaching(const Vec3& joint, const Vec3& end, float first_m, float second_m, bool arm) {
  const double x = static_cast<double>(end.x - joint.x), z = static_cast<double>(end.z - joint.z);
  const double a = static_cast<double>(first_m), b = static_cast<double>(second_m);
  const double far = std::clamp(std::hypot(x, z), std::abs(a - b) + 1e-3, a + b - 1e-3);
  const double at_joint = std::acos((a * a + far * far - b * b) / (2 * a * far));
  const double at_middle = std::acos((a * a + b * b - far * far) / (2 * a * b));
  return {joint, std::atan2(x, -z) + (arm ? -at_joint : at_joint), std::numbers::pi - at_middle};
}

/// Two steps, as a share of the height: 1.37 m at 1.75 m.
constexpr double kStride = 0.78;

double phaseOf_rad(const Body& body, double driven_m, bool left) {
  const double strides = driven_m / (kStride * static_cast<double>(body.height));
  return 2 * std::numbers::pi * strides + (left ? 0 : std::numbers::pi);
}
/// Share of the full step: zero when standing with the legs together, one after half a meter.
double swing(double driven_m) { return std::clamp(driven_m / 0.5, 0.0, 1.0); }

/// Hip and knee over a stride: the leg swings ahead while the sine rises, and bends while it passes the other one.
Pose legAt(const Body& body, double driven_m, bool left) {
  const double phase = phaseOf_rad(body, driven_m, left), share = swing(driven_m);
  const double passing = std::max(0.0, std::cos(phase));
  Pose leg;
  leg.raised_rad = share * (0.38 * std::sin(phase) + 0.06);
  leg.bent_rad = share * (0.08 + 0.80 * passing * passing);
  leg.toes_down_rad = std::clamp(0.85 * (leg.raised_rad - leg.bent_rad), -0.4, 0.4);
  return leg;
}

/// Height of the lower end of heel and toes below the hip.
double reachDown_m(const Body& b, const Pose& leg) {
  const double thigh = -leg.raised_rad, shin = thigh + leg.bent_rad, foot = shin + leg.toes_down_rad;
  const auto z = [](double angle, float x, float up) {
    return -std::sin(angle) * static_cast<double>(x) + std::cos(angle) * static_cast<double>(up);
  };
  const double ankle = z(thigh, 0, -b.thigh()) + z(shin, 0, -b.shin());
  return -ankle - std::min(z(foot, b.heel(), -b.foot()), z(foot, b.toe(), -b.foot()));
}

/// Height of the hips at which the lower foot touches the ground.
float hipHeight(const Body& body, double driven_m) {
  return static_cast<float>(
      std::max(reachDown_m(body, legAt(body, driven_m, true)), reachDown_m(body, legAt(body, driven_m, false))));
}

Model makeUpperBody(const Body& b, Random& random) {
  const float h = b.height;
  Model trunk = makeTrunk(b);
  trunk.addLimb(makeHead(b, false), [b](double) { return Limb::Pose{{0, 0, b.neck()}, 0}; });
  for (const bool left : {true, false}) {
    const float side = left ? 1.0F : -1.0F;
    addArm(trunk, b, [b, left, side](double driven_m) {
      const double back = 0.38 * swing(driven_m) * std::sin(phaseOf_rad(b, driven_m, left));
      return Pose{{0, side * b.shoulderSide(), b.shoulder()}, -back, 0.25 + std::max(0.0, -0.5 * back)};
    });
  }
  if (random.chance(0.4F)) {  // a rucksack
    const std::uint32_t pattern = random.bits();
    trunk.add(Material::kCloth, {-0.145F * h, -0.075F * h, 0.06F * h}, {-0.055F * h, 0.075F * h, 0.275F * h},
              random.uniform(0.05F, 0.5F), pattern);
    trunk.cutLast({-1, 0, 0.6F}, {-0.13F * h, 0, 0.25F * h});
  }
  if (random.chance(0.35F))  // a coat
    trunk.addCylinder(Material::kCloth, 2, {-0.078F * h, -0.107F * h, -0.11F * h}, {0.078F * h, 0.107F * h, 0.07F * h},
                      b.shirt, b.seed);
  return trunk;
}

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

Model makePedestrian(std::uint32_t seed) {
  Random random(seed + 200);
  const Body body = makeBody(seed);
  Model m;
  m.addLimb(makeUpperBody(body, random), [body](double driven_m) {
    return Limb::Pose{{0, 0, hipHeight(body, driven_m)}, 0.05};
  });
  for (const bool left : {true, false})
    addLeg(m, body, [body, left](double driven_m) {
      Pose leg = legAt(body, driven_m, left);
      leg.joint = {0, left ? body.hipSide() : -body.hipSide(), hipHeight(body, driven_m)};
      return leg;
    });
  m.kitti_type = "Pedestrian";
  fitBox(m, kStride * static_cast<double>(body.height) * 2);
  return m;
}

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
