#include "apps/synth/textures/texture.hpp"
#include "apps/synth/textures/texture_strokes.hpp"

namespace motorcade::synth {
namespace {

constexpr float kSill_m = 1.28F, kLintel_m = 2.52F;  // lower and upper edge of the side windows

/// Panels with joints, a stripe in the line's color, advertising in large letters, dirt from below.
float panels(const SurfacePoint& s, float u, float v) {
  const float f = s.footprint_m;
  const std::uint32_t seed = s.part->seed;
  const bool light = s.part->tone > 0.35F;
  float tone = s.part->tone * (1 + 0.15F * fractal2(u, v, {0.7F, 5, 0.65F}, f, seed));
  tone = lerp(tone, light ? 0.12F : 0.6F, inside(v, 0.98F, 1.16F, f));
  if ((seed & 16U) != 0)
    tone =
        lerp(tone, light ? 0.2F : 0.65F, writing(u, v - 0.5F, 0.34F, 0.42F, f, seed + 5) * inside(v, 0.52F, 0.9F, f));
  tone = lerp(tone, light ? 0.15F : 0.6F,
              writing(u, v - 2.62F, 0.13F, 0.2F, f, seed + 6) * inside(v, 2.62F, 2.8F, f) * inside(u, -3, 1.5F, f));
  tone *= 1 - 0.6F * std::fmax(pulses(u, 1.47F, 0.016F, f), line(v, 2.9F, 0.03F, f));
  return lerp(tone, 0.10F, saturate((0.75F - v) * 1.3F) * 0.6F);
}

/// A dark room with heads, seat backs and hand rails behind the panes.
float throughGlass(const SurfacePoint& s, float u, float v) {
  const float f = s.footprint_m, seat = 0.78F, column = std::floor(u / seat);
  const float across = u - seat * column;
  const bool taken = hashOf(static_cast<int>(column), s.normal.y > 0 ? 1 : 0, s.part->seed + 2) % 5 < 2;
  float tone = 0.035F + 0.04F * saturate(1.4F * fractal2(u, v, {0.5F, 4, 0.7F}, f, s.part->seed + 3));
  tone = lerp(tone, 0.09F, inside(across, 0.08F, 0.2F, f) * inside(v, kSill_m, 1.72F, f));
  if (taken) {
    tone = lerp(tone, 0.16F, inside(std::hypot(across - 0.42F, v - 1.82F), -1, 0.11F, f));
    tone = lerp(tone, 0.07F, inside(across, 0.22F, 0.62F, f) * inside(v, kSill_m, 1.7F, f));
  }
  return tone;
}

Reflectance pane(float body, float behind, float share) { return {lerp(body, behind, share), 0.09F * share, 0}; }

Reflectance side(const SurfacePoint& s) {
  const float f = s.footprint_m, u = s.position.x, v = s.position.z, front = s.part->hi.x;
  const float arch = saturate(0.5F - (wheelDistance(*s.model, s.position) - 0.05F) / std::fmax(f, 0.004F));
  const float body = panels(s, u, v) * (1 - 0.95F * arch);
  float glass = inside(v, kSill_m, kLintel_m, f) * (1 - pulses(u - front, 1.47F, 0.09F, f)) *
                inside(u, s.part->lo.x + 0.35F, front - 0.3F, f);
  float frame = inside(v, kSill_m - 0.05F, kLintel_m + 0.05F, f) * inside(u, s.part->lo.x + 0.3F, front - 0.25F, f);
  if (s.normal.y < 0)
    for (const float at : {front - 1.75F, -0.65F}) {  // doors
      const float leaf =
          std::fmax(line(u, at, 0.06F, f), std::fmax(line(u, at + 0.62F, 0.07F, f), line(u, at + 1.24F, 0.06F, f)));
      const float opening = inside(u, at, at + 1.24F, f) * inside(v, 0.42F, kLintel_m, f);
      glass = std::fmax(glass, opening) * (1 - leaf * inside(v, 0.4F, kLintel_m, f));
      frame = std::fmax(frame, opening);
    }
  return pane(lerp(body, 0.03F, frame * (1 - glass) * 0.8F), throughGlass(s, u, v), glass * (1 - arch));
}

Reflectance front(const SurfacePoint& s) {
  const float f = s.footprint_m, y = s.position.y, v = s.position.z, half = s.part->hi.y;
  const float body = panels(s, y, v);
  const float glass = inside(v, 1.12F, 2.50F, f) * inside(y, 0.08F - half, half - 0.08F, f);
  const float board = inside(v, 2.58F, 2.88F, f) * inside(y, 0.35F - half, half - 0.35F, f);
  const float letters = board * writing(y, v - 2.62F, 0.13F, 0.22F, f, s.part->seed + 9) * inside(v, 2.62F, 2.84F, f);
  float behind = 0.04F + 0.05F * inside(v, 1.12F, 1.35F, f);
  behind = lerp(behind, 0.12F, inside(std::hypot(y - 0.55F, v - 1.75F), -1, 0.13F, f));  // the driver
  behind = lerp(behind, 0.01F, line(y, 0, 0.04F, f));
  return {lerp(lerp(body, behind, glass), 0.03F, board), 0.09F * glass, 0.5F * letters};
}

Reflectance rear(const SurfacePoint& s) {
  const float f = s.footprint_m, y = s.position.y, v = s.position.z, half = s.part->hi.y;
  const float body = panels(s, y, v) * (1 - 0.6F * pulses(v, 0.07F, 0.03F, f) * inside(v, 0.6F, 0.95F, f) *
                                                inside(std::abs(y), 0, 0.75F, f));
  const float glass = inside(v, 1.75F, 2.5F, f) * inside(y, 0.25F - half, half - 0.25F, f);
  const float board = inside(v, 2.58F, 2.85F, f) * inside(y, -0.35F, 0.35F, f);
  const float number = board * writing(y, v - 2.6F, 0.16F, 0.24F, f, s.part->seed + 9);
  return {lerp(lerp(body, throughGlass(s, y, v), glass), 0.03F, board), 0.09F * glass, 0.5F * number};
}

}  // namespace

Reflectance coachReflectance(const SurfacePoint& s) {
  if (std::abs(s.normal.y) > 0.7F) return side(s);
  if (s.normal.x > 0.6F) return front(s);
  if (s.normal.x < -0.6F) return rear(s);
  return {panels(s, s.position.x, 2), 0.03F, 0};
}

}  // namespace motorcade::synth
