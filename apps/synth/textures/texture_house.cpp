#include <numbers>

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/textures/texture.hpp"

namespace motorcade::synth {
namespace {

/// Distance along a wall or roof whose rows are level.
float alongRow(const SurfacePoint& s) {
  return std::abs(s.normal.y) >= std::abs(s.normal.x) ? s.position.x : s.position.y;
}

/// A shade of its own for each piece of a pattern, as far as the pixel tells pieces apart.
float pieceShade(const SurfacePoint& s, float column, float row, float size_m) {
  const float shade = unit(hashOf(static_cast<int>(column), static_cast<int>(row), s.part->seed)) - 0.5F;
  return shade * visible(size_m, s.footprint_m);
}

/// Bricks as alike as fired in one kiln: light joints, hardly any stains.
float brickwork(const SurfacePoint& s) {
  constexpr float kBrick_m = 0.25F, kCourse_m = 0.125F, kJoint_m = 0.018F;
  const float f = s.footprint_m, v = s.position.z, row = std::floor(v / kCourse_m);
  const float u = alongRow(s) + (static_cast<int>(row) % 2 == 0 ? 0 : 0.5F * kBrick_m);
  const float joint = std::fmax(pulses(v, kCourse_m, kJoint_m, f), pulses(u, kBrick_m, kJoint_m, f));
  const float soot = fractal2(u, v, {5, 6, 0.6F}, f, s.part->seed + 1);
  const float brick = 1 + 0.25F * pieceShade(s, std::floor(u / kBrick_m), row, kCourse_m) + 0.08F * soot;
  return lerp(s.part->tone * brick, 0.5F, 0.8F * joint);
}

/// Pantiles in rows down a slope: a wave across, a shadow below each row's edge.
float tiles(const SurfacePoint& s) {
  constexpr float kTile_m = 0.26F, kRow_m = 0.36F, kEdge_m = 0.05F, kTurn = 2 * std::numbers::pi_v<float>;
  const float f = s.footprint_m, slope = std::hypot(s.normal.x, s.normal.y);
  const float u = alongRow(s), v = (s.part->hi.z - s.position.z) / std::fmax(slope, 0.1F);
  const float wave = std::cos(kTurn * u / kTile_m) * visible(0.5F * kTile_m, f);
  const float moss = fractal2(u, v, {1.4F, 5, 0.65F}, f, s.part->seed + 1);
  const float tile =
      1 + 0.35F * wave + 0.35F * pieceShade(s, std::floor(u / kTile_m), std::floor(v / kRow_m), kTile_m) + 0.12F * moss;
  return s.part->tone * tile * (1 - 0.75F * pulses(v, kRow_m, kEdge_m, f));
}

/// Slats of a shutter in a frame: level, fine, all alike.
float slats(const SurfacePoint& s) {
  constexpr float kSlat_m = 0.055F, kGap_m = 0.02F, kFrame_m = 0.05F;
  const float f = s.footprint_m, v = s.position.z - s.part->lo.z, height = s.part->hi.z - s.part->lo.z;
  const float u = alongRow(s), middle = 0.5F * height;
  const bool along_x = std::abs(s.normal.y) >= std::abs(s.normal.x);
  const float from = along_x ? s.part->lo.x : s.part->lo.y, to = along_x ? s.part->hi.x : s.part->hi.y;
  const float bars = 1 - inside(v, middle - kFrame_m, middle + kFrame_m, f);
  const float field = inside(u, from + kFrame_m, to - kFrame_m, f) * inside(v, kFrame_m, height - kFrame_m, f) * bars;
  return s.part->tone * (1 - 0.8F * field * pulses(v, kSlat_m, kGap_m, f));
}

/// A window of four lights before a dark room; shows the sky faintly.
Reflectance pane(const SurfacePoint& s) {
  constexpr float kFrame_m = 0.07F;
  const float f = s.footprint_m, v = s.position.z - s.part->lo.z, height = s.part->hi.z - s.part->lo.z;
  const bool along_x = std::abs(s.normal.y) >= std::abs(s.normal.x);
  const float u = alongRow(s) - (along_x ? s.part->lo.x : s.part->lo.y);
  const float width = along_x ? s.part->hi.x - s.part->lo.x : s.part->hi.y - s.part->lo.y;
  const float mullion = inside(u, 0.5F * (width - kFrame_m), 0.5F * (width + kFrame_m), f);
  const float transom = inside(v, 0.65F * height, 0.65F * height + kFrame_m, f);
  const float glass = inside(u, kFrame_m, width - kFrame_m, f) * inside(v, kFrame_m, height - kFrame_m, f) *
                      (1 - std::fmax(mullion, transom));
  const float curtain = 1 - inside(u, 0.25F * width, 0.75F * width, f);
  const float room = lerp(0.04F, 0.24F * (0.7F + 0.5F * pulses(u, 0.1F, 0.05F, f)), curtain);
  return {lerp(s.part->tone, room, glass), 0.12F * glass, 0};
}

}  // namespace

Reflectance houseReflectance(const SurfacePoint& s) {
  switch (s.part->material) {
    case Material::kBrickwork:
      return {brickwork(s), 0, 0};
    case Material::kTiles:
      return {tiles(s), 0, 0};
    case Material::kSlats:
      return {slats(s), 0, 0};
    default:
      return pane(s);
  }
}

}  // namespace motorcade::synth
