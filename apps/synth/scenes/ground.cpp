#include "apps/synth/scenes/ground.hpp"

#include "apps/synth/shapes/noise.hpp"

namespace motorcade::synth {
namespace {

constexpr float kCrosswalkHalf_m = 1.6F;

}  // namespace

/// Footprint of the pixel on the ground: long in the direction of view, narrow across.
struct Ground::View {
  float x, y;                     // direction of view on the ground
  float length, width;            // of the pixel's footprint
  float along_road, across_road;  // footprint in the road's axes
  std::uint32_t seed;

  /// Mean of a noise over the footprint: samples spread along its long side, each filtered by what is left.
  float texture(float px, float py, float spacing, int octaves, float gain, std::uint32_t salt) const {
    const int taps = std::clamp(static_cast<int>(length / (2 * width)), 1, 3);
    float sum = 0;
    for (int i = 0; i < taps; ++i) {
      const float shift = length * ((static_cast<float>(i) + 0.5F) / static_cast<float>(taps) - 0.5F);
      sum += fractal2(px + shift * x, py + shift * y, {spacing, octaves, gain},
                      std::max(width, 0.8F * length / static_cast<float>(taps)), seed + salt);
    }
    return sum / static_cast<float>(taps);
  }
};

Ground::Ground(const FrameScene& frame)
    : scene_(&frame.scene()),
      camera_x_m_(frame.T_map_cam().translation().x()),
      camera_y_m_(frame.T_map_cam().translation().y()),
      camera_z_m_(static_cast<float>(frame.T_map_cam().translation().z())) {}

std::optional<Ground::Hit> Ground::hit(const Vec3& origin, const Vec3& direction, float t_max) const {
  if (direction.z > -kLevel) return std::nullopt;
  // A reflected ray may start below the curb's height.
  const float high_t = std::max(0.0F, (kCurb_m - camera_z_m_ - origin.z) / direction.z),
              low_t = farthest(origin, direction);
  if (high_t >= t_max) return std::nullopt;
  const auto locate = [&](float t) {
    const Vec3 p = origin + direction * t;
    return scene_->roads.locate(camera_x_m_ + static_cast<double>(p.x), camera_y_m_ + static_cast<double>(p.y));
  };
  const auto at = [&](float t, const Vec3& normal, const RoadPosition& where, bool curb) {
    const Vec3 p = origin + direction * t;
    return Hit{t,
               normal,
               where,
               {static_cast<float>(camera_x_m_) + p.x, static_cast<float>(camera_y_m_) + p.y, camera_z_m_ + p.z},
               curb};
  };
  const auto onRoad = [&](const RoadPosition& where) {
    return low_t < t_max ? std::optional(at(low_t, {0, 0, 1}, where, false)) : std::nullopt;
  };
  const auto low = locate(low_t);
  // Too far from the curb to have been beyond it one curb higher.
  if (low.outside_m < -(low_t - high_t) * std::hypot(direction.x, direction.y)) return onRoad(low);
  const auto high = locate(high_t);
  if (high.outside_m >= 0) return at(high_t, {0, 0, 1}, high, false);
  if (low.outside_m <= 0) return onRoad(low);
  // Between the two planes the ray runs into the face of the curb.
  float before = high_t, after = low_t, inside_m = high.outside_m, outside_m = low.outside_m;
  RoadPosition where = low;
  float t = after;
  for (int i = 0; i < 5 && std::abs(where.outside_m) > 2e-5F; ++i) {
    t = before + (after - before) * inside_m / (inside_m - outside_m);
    where = locate(t);
    (where.outside_m < 0 ? before : after) = t;
    (where.outside_m < 0 ? inside_m : outside_m) = where.outside_m;
  }
  if (t >= t_max) return std::nullopt;
  const float towards = where.left_m > 0 ? 1.0F : -1.0F;
  return at(t, {towards * where.along_y, -towards * where.along_x, 0}, where, true);
}

float Ground::asphalt(const Hit& hit, const View& view) const {
  const float x = hit.position_map.x, y = hit.position_map.y;
  float tone = 0.155F;
  // Repairs: rectangles of other asphalt with a dark seam.
  const float length = 9, width = 1.7F, s = hit.where.along_m, d = hit.where.left_m + 40;
  const float column = std::floor(s / length), row = std::floor(d / width);
  const std::uint32_t bits = hashOf(static_cast<int>(column), static_cast<int>(row), view.seed + 3);
  if (bits % 4 == 0) {
    const float from = 1 + 3 * unit(mix(bits)), to = from + 1.2F + 3.4F * unit(mix(bits + 1));
    const float u = s - column * length, v = d - row * width;
    const float patch = inside(u, from, to, view.along_road) * inside(v, 0.15F, width - 0.1F, view.across_road);
    const float core =
        inside(u, from + 0.05F, to - 0.05F, view.along_road) * inside(v, 0.2F, width - 0.15F, view.across_road);
    tone = lerp(tone, lerp(0.07F, (bits & 16U) != 0 ? 0.105F : 0.215F, core / std::fmax(patch, 1e-3F)), patch);
  }
  const float cracks = view.texture(x, y, 2.1F, 3, 0.5F, 40);
  tone *= 1 - 0.55F * saturate(1 - std::abs(cracks) / (0.025F + 0.5F * view.width)) *
                  saturate(0.06F / (0.01F + view.width));
  const float lid_s = s - 23 * std::floor(s / 23) - 11,
              lid_d = hit.where.left_m - (hashOf(static_cast<int>(s / 23), 0, view.seed) % 2 == 0 ? 1.2F : -2.1F);
  const float lid = inside(std::hypot(lid_s, lid_d), -1, 0.34F, view.length);
  tone = lerp(
      tone,
      0.10F + 0.16F * pulses(lid_s, 0.11F, 0.05F, view.along_road) * pulses(lid_d + 9, 0.11F, 0.06F, view.across_road),
      lid);
  const float wear = view.texture(x, y, 3.7F, 4, 0.7F, 10), grain = view.texture(x, y, 0.22F, 5, 0.86F, 20);
  return tone * std::fmax(0.25F, 1 + 0.20F * wear + 0.50F * grain);
}

/// Coverage by lane paint.
float Ground::paint(const Hit& hit, const View& view) const {
  const Road& road = scene_->roads.roads()[hit.where.road];
  if (hit.where.next_outside_m < 1.0F) return 0;  // a junction
  float coverage = 0;
  for (const double at_m : road.crosswalks_m) {
    const auto center = static_cast<float>(at_m);
    coverage = std::fmax(
        coverage, inside(hit.where.along_m, center - kCrosswalkHalf_m, center + kCrosswalkHalf_m, view.along_road) *
                      pulses(hit.where.left_m + 0.25F, 1, 0.5F, view.across_road));
  }
  for (const auto& line : road.lines) {
    const auto center = static_cast<float>(line.left_m), half = 0.5F * static_cast<float>(line.width_m);
    const float across = inside(hit.where.left_m, center - half, center + half, view.across_road);
    if (across > 0)
      coverage =
          std::fmax(coverage, across * (line.dashed ? pulses(hit.where.along_m, 9, 3.4F, view.along_road) : 1.0F));
  }
  if (coverage <= 0) return 0;
  const float worn = view.texture(hit.position_map.x, hit.position_map.y, 0.35F, 5, 0.8F, 30);
  return coverage * saturate(0.85F + 0.35F * worn);
}

float Ground::beside(const Hit& hit, const View& view) const {
  const float x = hit.position_map.x, y = hit.position_map.y;
  if (hit.curb_face || hit.where.outside_m < 0.16F) {
    const float joint = pulses(hit.where.along_m, 1, 0.02F, view.along_road);
    return 0.34F * (1 - 0.6F * joint) * (1 + 0.3F * view.texture(x, y, 0.5F, 5, 0.75F, 50));
  }
  if (scene_->meadow || hit.where.outside_m > 3.6F) {
    const float tufts = view.texture(x, y, 2.5F, 8, 0.82F, 60);
    return std::fmax(0.03F, 0.135F * (1 + 0.55F * tufts));
  }
  const float size = 0.55F;
  const float column = std::floor(hit.where.along_m / size), row = std::floor(hit.where.outside_m / size);
  const float shade = unit(hashOf(static_cast<int>(column), static_cast<int>(row), view.seed + 70)) - 0.5F;
  const float joint = std::fmax(pulses(hit.where.along_m, size, 0.022F, view.along_road),
                                pulses(hit.where.outside_m, size, 0.022F, view.across_road));
  const float dirt = view.texture(x, y, 1.8F, 6, 0.74F, 80);
  return 0.27F * (1 + 0.5F * shade * visible(size, view.along_road) - 0.5F * joint) * (1 + 0.32F * dirt);
}

float Ground::reflectance(const Hit& hit, const Vec3& direction, float width_m) const {
  const float flat = std::hypot(direction.x, direction.y);
  View view{direction.x / flat,
            direction.y / flat,
            width_m * std::hypot(flat, direction.z) / std::fmax(-direction.z, 1e-3F),
            width_m,
            0,
            0,
            scene_->seed * 101U};
  if (hit.curb_face) view.length = 2 * width_m;
  const float cosine = std::abs(view.x * hit.where.along_x + view.y * hit.where.along_y),
              sine = std::sqrt(std::fmax(0.0F, 1 - cosine * cosine));
  view.along_road = view.length * cosine + width_m * sine;
  view.across_road = view.length * sine + width_m * cosine;
  if (hit.curb_face || hit.where.outside_m > 0) return beside(hit, view);
  return lerp(asphalt(hit, view), 0.62F, paint(hit, view));
}

}  // namespace motorcade::synth
