#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/textures/texture.hpp"

namespace motorcade::synth {
namespace {

/// Coordinates on a wall: along it and up.
struct WallPoint {
  float u, v, width;
};
WallPoint onWall(const SurfacePoint& s) {
  const bool along_x = std::abs(s.normal.y) > std::abs(s.normal.x);
  return along_x ? WallPoint{s.position.x - s.part->lo.x, s.position.z, s.part->hi.x - s.part->lo.x}
                 : WallPoint{s.position.y - s.part->lo.y, s.position.z, s.part->hi.y - s.part->lo.y};
}

/// Masonry: single bricks near by, stains and weathering at every distance.
float masonry(const SurfacePoint& s, const WallPoint& w) {
  const float f = s.footprint_m;
  const bool brick = s.part->material == Material::kBrick;
  const float course = brick ? 0.12F : 0.42F, width = brick ? 0.36F : 0.95F;
  const float row = std::floor(w.v / course), shift = (static_cast<int>(row) & 1) != 0 ? 0.5F * width : 0;
  const float column = std::floor((w.u + shift) / width);
  const float shade = unit(hashOf(static_cast<int>(column), static_cast<int>(row), s.part->seed)) - 0.5F;
  const float joint = std::fmax(pulses(w.v, course, 0.016F, f), pulses(w.u + shift, width, 0.016F, f));
  const float fine = visible(course, f);
  const float stains = fractal2(w.u, w.v * 0.5F, {2.6F, 7, 0.72F}, f, s.part->seed + 1);
  return s.part->tone * (1 + fine * ((brick ? 0.75F : 0.2F) * shade + (brick ? 0.5F : -0.3F) * joint) + 0.30F * stains);
}

/// One window: frame, cross bar, curtains or dark room, sill.
Reflectance window(float x, float y, float width, float height, float f, std::uint32_t bits) {
  const float frame = 1 - inside(x, 0.08F, width - 0.08F, f) * inside(y, 0.08F, height - 0.08F, f);
  const float bars = std::fmax(inside(x, 0.5F * width - 0.035F, 0.5F * width + 0.035F, f),
                               inside(y, 0.66F * height - 0.03F, 0.66F * height + 0.03F, f));
  const float blind = (bits & 3U) == 0 ? 0.45F : 0.05F;
  const float drawn = height * (0.3F + 0.6F * unit(mix(bits)));
  float room = lerp(0.03F, blind, inside(y, drawn, height, f));
  const float curtain = ((bits >> 4) & 1U) != 0 ? 0.35F : 0.06F;
  room = lerp(room, curtain * (0.7F + 0.5F * pulses(x, 0.12F, 0.06F, f)), 1 - inside(x, 0.2F * width, 0.8F * width, f));
  const float wood = std::fmax(frame, bars);
  return {lerp(room, ((bits >> 6) & 1U) != 0 ? 0.62F : 0.14F, wood), lerp(0.14F, 0.0F, wood), 0};
}

Reflectance facade(const SurfacePoint& s) {
  if (s.normal.z > 0.7F) return {0.2F, 0, 0};
  const WallPoint w = onWall(s);
  const float f = s.footprint_m, story = 3.1F;
  float wall = masonry(s, w);
  wall *= 1 - 0.35F * pulses(w.v + 0.1F, story, 0.14F, f) - 0.3F * inside(w.v, 0, 0.5F, f);
  wall *= 1 - 0.6F * inside(std::abs(w.u - 0.5F), 0, 0.06F, f);  // rain pipe
  const float bay = 2.5F + 0.9F * unit(mix(s.part->seed + 2)), wide = 1.15F + 0.4F * unit(mix(s.part->seed + 3)),
              high = 1.6F;
  const float column = std::floor(w.u / bay), row = std::floor(w.v / story);
  const float margin = 0.5F * (bay - wide);
  const std::uint32_t bits = hashOf(static_cast<int>(column), static_cast<int>(row), s.part->seed + 4);
  const bool last = (column + 1) * bay > w.width - 0.2F;
  const bool door = row == 0 && (bits % 5) == 0;
  const float x = w.u - column * bay - margin, y = w.v - row * story - (door ? 0.0F : 0.9F);
  const float tall = door ? 2.3F : high;
  if (last || w.v > s.part->hi.z - 0.5F) return {wall, 0, 0};
  const float opening = inside(x, 0, wide, f) * inside(y, 0, tall, f);
  const float sill =
      inside(x, -0.1F, wide + 0.1F, f) * std::fmax(inside(y, -0.12F, 0, f), 0.6F * inside(y, tall, tall + 0.18F, f));
  wall = lerp(wall, 0.55F, sill);
  if (opening <= 0) return {wall, 0, 0};
  const Reflectance pane = window(x, y, wide, tall, f, bits);
  return {lerp(wall, pane.diffuse, opening), pane.mirror * opening, 0};
}

/// Leaves as light and dark clumps at all sizes; the inside of a crown is darker.
float leaves(const SurfacePoint& s) {
  const Vec3& p = s.position;
  const float size_m = s.part->material == Material::kFoliage ? 0.13F : 0.42F;
  const float clumps = fractal3(p.x, p.y, p.z, {size_m, 4, 0.9F}, s.footprint_m, s.part->seed + 17);
  const float bright = saturate(0.5F + 0.85F * clumps);
  return lerp(0.02F, 2.6F * s.part->tone, bright * bright);
}

Reflectance sign(const SurfacePoint& s) {
  const WallPoint w = onWall(s);
  const float f = s.footprint_m, height = s.part->hi.z - s.part->lo.z, v = s.position.z - s.part->lo.z;
  const float border =
      1 - inside(w.u, 0.06F * w.width, 0.94F * w.width, f) * inside(v, 0.06F * height, 0.94F * height, f);
  const float cell = height / 7;
  const float column = std::floor(w.u / cell), row = std::floor(v / cell);
  const bool ink =
      hashOf(static_cast<int>(column), static_cast<int>(row), s.part->seed) % 5 < 2 && static_cast<int>(row) % 2 == 1;
  const float mark = ink ? inside(w.u - column * cell, 0.1F * cell, 0.8F * cell, f) *
                               inside(v - row * cell, 0.05F * cell, 0.95F * cell, f)
                         : 0;
  const float ground = s.part->tone, letters = ground > 0.4F ? 0.06F : 0.85F;
  return {lerp(lerp(ground, letters, mark), letters, border), 0, 0};
}

/// Dark paint under dust, with two creases.
Reflectance bonnet(const SurfacePoint& s) {
  constexpr float kCrease_m = 0.52F;
  const Vec3& p = s.position;
  const float f = s.footprint_m, middle = 0.5F * (s.part->lo.y + s.part->hi.y);
  const float dust = fractal3(p.x, p.y, p.z, {0.03F, 4, 0.8F}, f, s.part->seed);
  const float crease = inside(std::abs(p.y - middle), kCrease_m, kCrease_m + 0.012F, f);
  return {s.part->tone * (1 + 0.35F * dust) * (1 - 0.6F * crease), 0.06F * (1 - 0.5F * crease), 0};
}

float planks(const SurfacePoint& s) {
  const WallPoint w = onWall(s);
  const float board = std::floor(w.u / 0.14F);
  const float shade = unit(hashOf(static_cast<int>(board), 3, s.part->seed)) - 0.5F;
  const float grain = fractal2(w.u * 6, w.v, {0.4F, 4, 0.7F}, s.footprint_m, s.part->seed);
  return s.part->tone * (1 + visible(0.14F, s.footprint_m) * 0.6F * shade + 0.2F * grain -
                         0.7F * pulses(w.u, 0.14F, 0.012F, s.footprint_m));
}

}  // namespace

Reflectance streetReflectance(const SurfacePoint& s) {
  const Vec3& p = s.position;
  const float f = s.footprint_m;
  switch (s.part->material) {
    case Material::kBrick:
    case Material::kPlaster:
      return facade(s);
    case Material::kLeaves:
    case Material::kHedge:
    case Material::kFoliage:
      return {leaves(s), 0, 0};
    case Material::kSign:
      return sign(s);
    case Material::kBrickwork:
    case Material::kTiles:
    case Material::kSlats:
    case Material::kPane:
      return houseReflectance(s);
    case Material::kBonnet:
      return bonnet(s);
    case Material::kWood:
      return {planks(s), 0, 0};
    case Material::kRoof:
      return {s.part->tone * (1 - 0.4F * pulses(p.z, 0.22F, 0.05F, f) +
                              0.25F * fractal3(p.x, p.y, p.z, {0.9F, 4, 0.7F}, f, s.part->seed)),
              0, 0};
    case Material::kBark:
      return {s.part->tone * (1 + 0.6F * fractal3(p.x * 2, p.y * 2, p.z * 0.6F, {0.22F, 4, 0.75F}, f, s.part->seed)), 0,
              0};
    default:
      return {s.part->tone * (1 + 0.28F * fractal3(p.x, p.y, p.z, {1.1F, 6, 0.72F}, f, s.part->seed)), 0, 0};
  }
}

Reflectance reflectanceOf(const SurfacePoint& point) {
  const Material material = point.part->material;
  if (material >= Material::kCloth) return personReflectance(point);
  return material < Material::kBrick ? vehicleReflectance(point) : streetReflectance(point);
}

}  // namespace motorcade::synth
