#include "apps/synth/models/garden_model.hpp"

#include <numbers>

namespace motorcade::synth {
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
    branch.addEllipsoid(Material::kFoliage, {}, {size, size, 0.75F * size}, tone * random.uniform(0.8F, 1.3F),
                        random.bits());
    const Wind wind{static_cast<double>(lerp(kLowest_m, kHighest_m, up)), towards_rad, gust_rad,
                    random.uniform(0, 6.28F)};
    m.addLimb(std::move(branch), [wind, rest](double t_s) { return wind.at(t_s, rest); });
  }
  return m;
}

}  // namespace motorcade::synth
