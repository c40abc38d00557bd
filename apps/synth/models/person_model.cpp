#include "apps/synth/models/person_model.hpp"

#include <numbers>

#include "apps/synth/models/body_parts.hpp"
#include "apps/synth/models/model_size.hpp"

namespace motorcade::synth {
namespace {

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
    trunk.add(Material::kCloth, {-0.145F * h, -0.075F * h, 0.06F * h}, {-0.055F * h, 0.075F * h, 0.275F * h},
              random.uniform(0.05F, 0.5F), random.bits());
    trunk.cutLast({-1, 0, 0.6F}, {-0.13F * h, 0, 0.25F * h});
  }
  if (random.chance(0.35F))  // a coat
    trunk.addCylinder(Material::kCloth, 2, {-0.078F * h, -0.107F * h, -0.11F * h}, {0.078F * h, 0.107F * h, 0.07F * h},
                      b.shirt, b.seed);
  return trunk;
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

}  // namespace motorcade::synth
