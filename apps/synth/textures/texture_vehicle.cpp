#include <numbers>

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/textures/texture.hpp"

namespace motorcade::synth {
namespace {

/// A thin line at `at`.
float line(float x, float at, float width, float footprint) {
  return inside(x, at - 0.5F * width, at + 0.5F * width, footprint);
}

/// Glyphs: a grid of cells that hold strokes chosen by a hash; 1 on ink.
float writing(float u, float v, float cell_width, float cell_height, float footprint, std::uint32_t seed) {
  const float column = std::floor(u / cell_width), row = std::floor(v / cell_height);
  const float x = u / cell_width - column, y = v / cell_height - row;
  const float fx = footprint / cell_width, fy = footprint / cell_height;
  const std::uint32_t bits = hashOf(static_cast<int>(column), static_cast<int>(row), seed);
  float ink = 0;
  const auto stroke = [&](unsigned bit, float x0, float x1, float y0, float y1) {
    if ((bits >> bit) & 1U) ink = std::fmax(ink, inside(x, x0, x1, fx) * inside(y, y0, y1, fy));
  };
  stroke(3, 0.12F, 0.32F, 0.12F, 0.88F);
  stroke(7, 0.62F, 0.82F, 0.12F, 0.88F);
  stroke(11, 0.12F, 0.82F, 0.12F, 0.30F);
  stroke(15, 0.12F, 0.82F, 0.41F, 0.59F);
  stroke(19, 0.12F, 0.82F, 0.70F, 0.88F);
  return ink;
}

/// Distance from the nearest wheel, in the side view; negative within it.
float wheelDistance(const Model& model, const Vec3& p) {
  float nearest = 1e9F;
  for (const auto& part : model.parts) {
    if (part.material != Material::kTire) continue;
    const Vec3 c = (part.lo + part.hi) * 0.5F;
    nearest = std::fmin(nearest, std::hypot(p.x - c.x, p.z - c.z) - 0.5F * (part.hi.z - part.lo.z));
  }
  return nearest;
}

constexpr float kClearCoat = 0.07F;  // share that clean paint mirrors head on: little more than polished glass

/// Body panels: door gaps, sills, wheel arches, a bright crease, grime from below and reflections of the street.
Reflectance paint(const SurfacePoint& s) {
  const Vec3& p = s.position;
  const float f = s.footprint_m, length = s.part->hi.x - s.part->lo.x;
  float tone = s.part->tone;
  float dark = 0;
  if (std::abs(s.normal.y) > 0.7F) {
    for (const float at : {-0.19F, 0.03F, 0.25F}) dark = std::fmax(dark, 0.85F * line(p.x, at * length, 0.016F, f));
    tone *= 1 + 0.5F * line(p.z, 0.72F, 0.03F, f) - 0.45F * line(p.z, 0.56F, 0.045F, f);
    dark = std::fmax(dark, 0.95F * saturate(0.5F - (wheelDistance(*s.model, p) - 0.045F) / std::fmax(f, 0.004F)));
    const float cap = std::hypot(p.x + 0.36F * length, p.z - 0.74F);
    dark = std::fmax(dark, 0.6F * inside(cap, 0.06F, 0.075F, f));
  } else if (std::abs(s.normal.x) > 0.6F) {
    dark = std::fmax(dark, 0.8F * line(p.z, 0.62F, 0.014F, f));
    dark = std::fmax(dark, 0.7F * line(std::abs(p.y), 0.62F, 0.012F, f) * inside(p.z, 0.5F, 1.0F, f));
    dark = std::fmax(dark, 0.8F * inside(std::abs(p.y), 0, 0.16F, f) * line(p.z, 0.79F, 0.025F, f));
  } else if (s.normal.z > 0.6F) {
    dark = std::fmax(dark, 0.7F * line(std::abs(p.y), 0.68F, 0.012F, f));
    dark = std::fmax(dark, 0.7F * line(std::abs(p.x), 0.27F * length, 0.014F, f));
  }
  if (s.model->smooth_paint) return {tone * (1 - dark), kClearCoat * (1 - dark), 0};
  const float sheen = fractal3(p.x, p.y, p.z * 1.7F, {0.42F, 5, 0.72F}, f, s.part->seed);
  const float grime =
      saturate((0.5F - p.z) * 2) * (0.35F + 0.5F * fractal3(p.x, p.y, p.z, {0.12F, 3, 0.7F}, f, s.part->seed + 9));
  tone = lerp(tone * (1 + 0.42F * sheen) + 0.06F * std::fmax(0.0F, sheen), 0.16F, saturate(grime));
  return {tone * (1 - dark), 0.10F * (1 - dark), 0};
}

/// The upper body: windows with pillars, frames and what is seen behind the glass; painted roof.
Reflectance cabin(const SurfacePoint& s) {
  const Vec3 &p = s.position, &lo = s.part->lo, &hi = s.part->hi;
  const float f = s.footprint_m, height = hi.z - lo.z;
  if (s.normal.z > 0.93F) return paint(s);
  const float v = (p.z - lo.z) / height, fv = f / height;
  float glass = inside(v, 0.12F, 0.86F, fv);
  if (std::abs(s.normal.y) > 0.7F) {
    const float u = (p.x - lo.x) / (hi.x - lo.x), fu = f / (hi.x - lo.x), lean = 0.22F * v;
    const float panes =
        inside(u, 0.10F + 0.5F * lean, 0.25F, fu) + inside(u, 0.28F, 0.515F, fu) + inside(u, 0.545F, 0.90F - lean, fu);
    glass *= saturate(panes);
  } else {
    const float half = 0.5F * (hi.y - lo.y) * (0.86F - 0.14F * v);
    glass *= inside(p.y, -half, half, f);
  }
  const Reflectance metal = paint(s);
  // Seats, headrests and the far windows show through the glass as fixed shapes; stickers and heating wires lie on it.
  float inner = 0.035F + 0.05F * saturate(fractal3(p.x, p.y, p.z, {0.30F, 3, 0.7F}, f, s.part->seed + 3) * 1.5F);
  if (std::abs(s.normal.x) > 0.5F) {
    for (const float at : {-0.36F, 0.36F})
      inner = lerp(inner, 0.015F, inside(p.y, at - 0.14F, at + 0.14F, f) * inside(v, 0.2F, 0.68F, fv));
    inner += 0.30F * inside(p.y, 0.44F, 0.53F, f) * inside(v, 0.18F, 0.36F, fv) * unit(mix(s.part->seed));
    inner += 0.02F * pulses(p.z, 0.045F, 0.008F, f);
  } else {
    inner = lerp(inner, 0.012F, inside(std::fmod(p.x + 10.0F, 0.95F), 0.25F, 0.52F, f) * inside(v, 0.15F, 0.7F, fv));
  }
  const float frame = inside(v, 0.09F, 0.89F, fv) * (1 - glass);  // black rubber round the panes
  return {lerp(lerp(metal.diffuse, 0.04F, 0.55F * frame), inner, glass), lerp(metal.mirror, 0.09F, glass), 0};
}

Reflectance wheel(const SurfacePoint& s) {
  const Vec3 c = (s.part->lo + s.part->hi) * 0.5F, p = s.position;
  const float radius = 0.5F * (s.part->hi.z - s.part->lo.z), f = s.footprint_m;
  if (std::abs(s.normal.y) < 0.7F) return {0.05F * (1 + 0.5F * pulses(p.y, 0.03F, 0.012F, f)), 0, 0};
  const float r = std::hypot(p.x - c.x, p.z - c.z) / radius, fr = f / radius;
  const float angle = angleOf(p.z - c.z, p.x - c.x) + s.wheel_angle_rad;
  const float sector = 2 * std::numbers::pi_v<float> / 5;
  const float turn = angle - sector * std::floor(angle / sector);
  const float spoke = inside(turn, 0.3F, 0.95F, fr / std::fmax(r, 0.1F));
  const float rim = std::fmax(inside(r, 0.56F, 0.68F, fr), inside(r, 0, 0.2F, fr));
  const float metal = std::fmax(rim, spoke * inside(r, 0, 0.68F, fr));
  const float lettering = 0.05F * inside(r, 0.78F, 0.86F, fr);
  return {lerp(0.045F + lettering, s.part->tone, metal), 0.04F * metal, 0};
}

Reflectance lamp(const SurfacePoint& s, bool rear) {
  const Vec3 &p = s.position, &lo = s.part->lo, &hi = s.part->hi;
  const float f = s.footprint_m, v = (p.z - lo.z) / (hi.z - lo.z), fv = f / (hi.z - lo.z);
  const float u = (p.y - lo.y) / (hi.y - lo.y), fu = f / (hi.y - lo.y);
  const float inner = p.y > 0 ? u : 1 - u;  // from the middle of the car outwards
  if (rear) {
    const float reverse = inside(inner, 0.08F, 0.38F, fu) * inside(v, 0.15F, 0.5F, fv);
    const float bulb = inside(std::hypot((inner - 0.7F), (v - 0.6F) * 0.8F), 0, 0.18F, fu);
    return {0.13F + 0.5F * reverse + 0.22F * bulb - 0.06F * line(v, 0.55F, 0.06F, fv), 0.08F, 0.02F * bulb};
  }
  const float bulb = inside(std::hypot(inner - 0.5F, (v - 0.5F) * 0.6F), 0, 0.24F, fu);
  return {0.55F - 0.35F * inside(v, 0.02F, 0.14F, fv) + 0.3F * bulb - 0.25F * line(inner, 0.25F, 0.08F, fu), 0.12F,
          0.1F * bulb};
}

Reflectance plate(const SurfacePoint& s) {
  const float f = s.footprint_m, y = s.position.y - s.part->lo.y, z = s.position.z - s.part->lo.z;
  const float width = s.part->hi.y - s.part->lo.y, height = s.part->hi.z - s.part->lo.z;
  const float field = inside(y, 0.03F, width - 0.03F, f) * inside(z, 0.018F, height - 0.018F, f);
  return {0.75F - 0.68F * field * writing(y - 0.03F, z - 0.018F, 0.062F, height - 0.036F, f, s.part->seed | 0x80000U),
          0.02F, 0};
}

/// A lorry's box: panel joints, rivets, a painted band with large writing, stains.
Reflectance cargo(const SurfacePoint& s) {
  const Vec3 &p = s.position, &lo = s.part->lo, &hi = s.part->hi;
  const bool side = std::abs(s.normal.y) > 0.7F;
  const float u = side ? p.x - lo.x : p.y - lo.y, v = p.z - lo.z, height = hi.z - lo.z, f = s.footprint_m;
  const float stains = fractal2(u, v * 0.6F, {0.8F, 5, 0.65F}, f, s.part->seed);
  float tone = s.part->tone * (1 + 0.16F * stains);
  const float band = inside(v, 0.30F * height, 0.74F * height, f);
  const float ink = writing(u, v - 0.32F * height, 0.30F * height, 0.40F * height, f, s.part->seed + 5) *
                    inside(v, 0.34F * height, 0.70F * height, f);
  const bool light = s.part->tone > 0.35F;
  tone = lerp(tone, light ? 0.14F : 0.55F, band * (side ? 0.75F : 0.5F));
  tone = lerp(tone, light ? 0.72F : 0.08F, ink);
  tone = lerp(tone, light ? 0.10F : 0.6F,
              writing(u, v - 0.80F * height, 0.16F, 0.11F * height, f, s.part->seed + 8) *
                  inside(v, 0.8F * height, 0.91F * height, f));
  tone = lerp(tone, light ? 0.12F : 0.5F,
              writing(u, v - 0.10F * height, 0.11F, 0.09F * height, f, s.part->seed + 7) *
                  inside(v, 0.1F * height, 0.19F * height, f));
  tone *= 1 - 0.6F * pulses(u + 0.006F, side ? 1.22F : 0.5F * (hi.y - lo.y), 0.018F, f);
  tone *= 1 - 0.45F * pulses(u, 0.15F, 0.022F, f) *
                  std::fmax(line(v, 0.05F, 0.025F, f), line(v, height - 0.05F, 0.025F, f));
  if (!side)
    tone *= 1 - 0.6F * std::fmax(line(std::abs(p.y), 0.25F, 0.03F, f),
                                 line(v, 0.3F * height, 0.03F, f) * inside(std::abs(p.y), 0.1F, 0.45F, f));
  return {tone, 0.03F, 0};
}

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

Reflectance vehicleReflectance(const SurfacePoint& s) {
  switch (s.part->material) {
    case Material::kPaint:
      return paint(s);
    case Material::kCabin:
      return cabin(s);
    case Material::kTire:
      return wheel(s);
    case Material::kHeadLamp:
      return lamp(s, false);
    case Material::kTailLamp:
      return lamp(s, true);
    case Material::kPlate:
      return plate(s);
    case Material::kCargo:
      return cargo(s);
    case Material::kGlass:
      return {s.part->tone, 0.2F, 0};
    case Material::kChrome:
      return {0.45F, 0.35F, 0};
    case Material::kCoach:
      return coachReflectance(s);
    case Material::kGrille:
      return {0.22F - 0.19F * pulses(s.position.z, 0.045F, 0.026F, s.footprint_m), 0.03F, 0};
    default:
      if (s.model->smooth_paint) return {s.part->tone, 0.04F, 0};
      return {s.part->tone * (1 + 0.25F * fractal3(s.position.x, s.position.y, s.position.z, {0.2F, 4, 0.7F},
                                                   s.footprint_m, s.part->seed)),
              0.02F, 0};
  }
}

Reflectance coachReflectance(const SurfacePoint& s) {
  if (std::abs(s.normal.y) > 0.7F) return side(s);
  if (s.normal.x > 0.6F) return front(s);
  if (s.normal.x < -0.6F) return rear(s);
  return {panels(s, s.position.x, 2), 0.03F, 0};
}

}  // namespace motorcade::synth
