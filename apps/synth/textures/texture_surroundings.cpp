#include <numbers>

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

/// Folds at all sizes; some cloth of an even seed has stripes or checks.
float cloth(const SurfacePoint& s) {
  const Vec3& p = s.position;
  const float f = s.footprint_m;
  float tone = s.part->tone;
  const std::uint32_t pattern = (s.part->seed & 1U) != 0 ? 5 : mix(s.part->seed) % 6;
  const float contrast = tone > 0.2F ? -0.6F : 1.6F;
  if (pattern == 0) tone *= 1 + contrast * pulses(p.z, 0.11F, 0.05F, f);
  if (pattern == 1) tone *= 1 + 0.5F * contrast * (pulses(p.z, 0.09F, 0.035F, f) + pulses(p.y, 0.09F, 0.035F, f));
  const float folds = fractal3(p.x, p.y, 0.6F * p.z, {0.13F, 5, 0.75F}, f, s.part->seed + 1);
  return std::fmax(0.015F, tone * (1 + 0.45F * folds));
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

Reflectance personReflectance(const SurfacePoint& s) {
  if (s.part->material == Material::kCloth) return {cloth(s), 0, 0};
  const Vec3& p = s.position;
  return {s.part->tone * (1 + 0.2F * fractal3(p.x, p.y, p.z, {0.06F, 3, 0.7F}, s.footprint_m, s.part->seed)), 0.02F, 0};
}

float skyRadiance(const Vec3& direction, float pixel_rad, std::uint32_t seed, bool overcast) {
  const float azimuth = angleOf(direction.y, direction.x), height = direction.z;
  // Hills and woods: ridge lines that close without a seam, since they are noise on the unit circle.
  const float cx = std::cos(azimuth), cy = std::sin(azimuth);
  const float ridge = 0.030F + 0.022F * fractal2(cx * 3, cy * 3, {1, 4, 0.6F}, 0, seed + 1) +
                      0.012F * fractal2(cx * 40, cy * 40, {1, 3, 0.7F}, 0, seed + 2);
  const float land = saturate((ridge - height) / pixel_rad + 0.5F);
  float sky = lerp(0.95F, 0.60F, saturate(height * 2.2F));
  if (land < 1) {
    const float reach = 1 / (std::fmax(height, 0.0F) + 0.12F);
    const float clouds =
        fractal2(direction.x * reach, direction.y * reach, {1.1F, 6, 0.58F}, pixel_rad * reach * 4, seed + 3);
    sky = overcast ? 0.80F + 0.10F * clouds : lerp(sky, 1.02F, saturate(0.9F * clouds + 0.25F));
  }
  const float trees = 0.12F + 0.06F * fractal2(azimuth * 60, height * 90, {2, 3, 0.7F}, pixel_rad * 75, seed + 4);
  return lerp(sky, std::fmax(0.04F, trees), land);
}

}  // namespace motorcade::synth
