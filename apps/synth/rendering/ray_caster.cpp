#include "apps/synth/rendering/ray_caster.hpp"

#include "apps/synth/rendering/film.hpp"
#include "apps/synth/shapes/noise.hpp"

namespace motorcade::synth {
namespace {

constexpr float kFar_m = 400, kMirrorReach_m = 150;
constexpr float kSun = 1.15F, kAmbient = 0.30F;
constexpr float kOvercast = 0.72F;  // light of a closed cover of clouds

constexpr std::uint32_t kSkySurface = 0xffffffffU, kRoadSurface = 0xfffffffeU, kCurbSurface = 0xfffffffdU,
                        kBesideSurface = 0xfffffffcU;

std::uint32_t surfaceOf(const Ground::Hit& hit) {
  return hit.curb_face ? kCurbSurface : hit.where.outside_m < 0 ? kRoadSurface : kBesideSurface;
}

Vec3 bounce(const Vec3& view, const Vec3& normal) { return view - normal * (2 * dot(view, normal)); }

float haze(float light, float depth_m) { return lerp(light, 0.55F, 1 - std::exp(-depth_m / 900)); }

bool anythingMirrors(const FrameScene& frame) {
  return frame.scene().rain || std::any_of(frame.placed().begin(), frame.placed().end(),
                                           [](const Placed& placed) { return placed.model->smooth_paint; });
}

}  // namespace

bool isLevelGround(std::uint32_t surface) { return surface == kRoadSurface || surface == kBesideSurface; }

RayCaster::RayCaster(const FrameScene& frame, const StereoCamera& camera, StereoSide side, Style style,
                     const CalibrationErrors& errors)
    : frame_(frame),
      style_(style),
      ground_(frame),
      lens_(camera, side, errors),
      rays_(frame, camera, side, lens_.beyond_px()),
      to_sun_(frame, frame.scene().sun),
      upwards_(frame, {0, 0, 1}),
      pixel_(static_cast<float>(1 / camera.fx_px)),
      sunlight_(frame.scene().rain ? 0 : kSun),
      skylight_(frame.scene().rain ? kOvercast : kAmbient) {
  if (anythingMirrors(frame)) tree_.emplace(frame);
}

Sample RayCaster::cast(float u_px, float v_px, float sharpness, const std::optional<Exposure>& known) const {
  const auto [exact_u_px, exact_v_px] = lens_.exact(u_px, v_px);
  const Ray ray{rays_.origin(), rays_.direction(exact_u_px, exact_v_px), pixel_ / sharpness};
  const float t_max = std::min(kFar_m, ground_.farthest(ray.origin, ray.direction));
  return sampleOf(ray, rays_.firstHit(exact_u_px, exact_v_px, ray.direction, t_max), known);
}

Sample RayCaster::sampleOf(const Ray& ray, const std::optional<RayHit>& hit,
                           const std::optional<Exposure>& known) const {
  const Vec3& d = ray.direction;
  const auto ground = ground_.hit(ray.origin, d, hit ? hit->t : kFar_m);
  if (ground) {
    const Exposure exposure = known ? *known : exposureOf(*ground, ray.origin + d * ground->t);
    const float dry = dryGround(*ground, ray), light = lit(ground->normal, exposure);
    const float seen =
        frame_.scene().rain ? haze(wet(*ground, ray, {dry, light}), ground->t) : haze(dry * light, ground->t);
    return {seen, ground->t, surfaceOf(*ground), -1, exposure};
  }
  if (hit) {
    const Vec3 normal = hit->placed->rotation * hit->normal_body;
    const Exposure exposure = known ? *known : Exposure{sunny(ray.origin + d * hit->t + normal * 2e-3F, normal), false};
    return {haze(shade(*hit, normal, ray, exposure), hit->t), hit->t, hit->surface,
            static_cast<std::int16_t>(hit->placed->id), exposure};
  }
  const Scene& scene = frame_.scene();
  return {skyRadiance(normalized(d), ray.pixel, scene.seed, scene.rain), 0, kSkySurface, -1, {}};
}

float RayCaster::dryGround(const Ground::Hit& hit, const Ray& ray) const {
  constexpr float kVeins = 0.6F;
  const float width_m = ray.width_m(hit.t), plain = ground_.reflectance(hit, ray.direction, width_m);
  if (style_ == Style::kPlain) return plain;
  const float slant = std::fmax(std::abs(dot(normalized(ray.direction), hit.normal)), 1e-3F);
  return veined(plain, hit.position_map, width_m / slant, frame_.scene().seed, kVeins);
}

Reflectance RayCaster::styled(const SurfacePoint& point) const {
  constexpr float kVeins = 0.7F, kVeinsOfPaint = 0.3F;
  Reflectance r = reflectanceOf(point);
  if (style_ == Style::kPlain || point.model->smooth_paint) return r;
  const bool made = point.part->material < Material::kBrick || point.part->material >= Material::kCloth;
  r.diffuse = veined(r.diffuse, point.position, point.footprint_m, point.part->seed, made ? kVeinsOfPaint : kVeins);
  return r;
}

bool RayCaster::sunny(const Vec3& position, const Vec3& normal) const {
  return sunlight_ > 0 && dot(normal, frame_.scene().sun) > 0 && !to_sun_.occluded(position, 60);
}

/// Exposure of a ground point. Little of the sky is seen under a car. The rays start on the ground itself, which is no
/// obstacle, so that tires shade the ground they stand on.
Exposure RayCaster::exposureOf(const Ground::Hit& hit, const Vec3& position) const {
  const bool sun = sunny(position, hit.normal);
  return {sun, !sun && hit.t < 60 && upwards_.occluded(position, 1.05F)};
}

/// Light on a surface, from the sky and from the sun.
float RayCaster::lit(const Vec3& normal, const Exposure& exposure) const {
  const float sky = skylight_ * (0.62F + 0.38F * normal.z) * (exposure.covered ? 0.35F : 1);
  return exposure.sunny ? sky + sunlight_ * std::fmax(0.0F, dot(normal, frame_.scene().sun)) : sky;
}

float RayCaster::shade(const RayHit& hit, const Vec3& normal, const Ray& ray, const Exposure& exposure) const {
  const Placed& placed = *hit.placed;
  const Vec3 view = normalized(ray.direction);
  const float slant = std::fmax(0.15F, std::abs(dot(normal, view)));
  // Geometric mean of the footprint's two sides; steep views are supersampled anyway.
  const SurfacePoint point{hit.part,
                           placed.model.get(),
                           hit.position_body,
                           hit.normal_body,
                           ray.width_m(hit.t) / std::sqrt(slant),
                           placed.wheel_angle_rad};
  const Reflectance r = styled(point);
  float light = r.diffuse * lit(normal, exposure) + r.glow;
  if (r.mirror > 0) {
    const float fresnel = r.mirror + (1 - r.mirror) * 0.6F * std::pow(1 - slant, 5.0F);
    const bool exact = placed.model->smooth_paint && !ray.mirrored;
    light += fresnel * (exact ? surroundings(hit, normal, ray)
                              : lerp(0.10F, 0.62F, saturate(bounce(view, normal).z * 3 + 0.35F)));
  }
  return light;
}

/// Light mirrored by smooth paint. Panels bulge: the normal leans outwards from the middle of the part.
float RayCaster::surroundings(const RayHit& hit, const Vec3& normal, const Ray& ray) const {
  constexpr float kBulge = 0.16F;  // tangent of the lean at the rim: some 9 degrees
  const Vec3 middle = (hit.part->lo + hit.part->hi) * 0.5F, half = (hit.part->hi - hit.part->lo) * 0.5F;
  const Vec3 from_middle = hit.position_body - middle;
  const Vec3 lean{from_middle.x / half.x, from_middle.y / half.y, from_middle.z / half.z};
  const Vec3 bulged = normalized(normal + hit.placed->rotation * (lean * kBulge));
  const Vec3& facing = dot(bulged, ray.direction) < 0 ? bulged : normal;
  constexpr float kDustySlope = 0.04F;
  return hit.part->material == Material::kBonnet ? smeared(ray, hit.t, facing, kDustySlope)
                                                 : mirrored(ray, hit.t, facing);
}

/// Light that a mirror with this normal sends along the ray from t on.
float RayCaster::mirrored(const Ray& ray, float t, const Vec3& normal) const {
  constexpr float kOff_m = 2e-3F;
  const Vec3 view = normalized(ray.direction);
  const Ray next{ray.origin + ray.direction * t + normal * kOff_m, bounce(view, normal), ray.pixel, ray.before_m + t,
                 true};
  const float t_max = std::min(kMirrorReach_m, ground_.farthest(next.origin, next.direction));
  return sampleOf(next, tree_->firstHit(next.origin, next.direction, t_max), {}).light;
}

/// Light of a rough mirror, which smears its image along the direction of view.
float RayCaster::smeared(const Ray& ray, float t, const Vec3& normal, float roughness) const {
  const Vec3 view = normalized(ray.direction);
  float light = 0;
  for (const float spread : kWaterSpread)
    light += mirrored(ray, t, normalized(normal + Vec3{view.x, view.y, 0} * (spread * roughness)));
  return light / static_cast<float>(kWaterSpread.size());
}

/// Light from wet ground. Water darkens the ground, and mirrors more at flatter angles.
float RayCaster::wet(const Ground::Hit& hit, const Ray& ray, const Lit& dry) const {
  const WaterFilm film = waterFilm(hit, ray.width_m(hit.t), frame_.scene(), frame_.frame());
  const float dark = dry.reflectance * dry.light * film.darkening;
  if (film.mirror <= 0 || ray.mirrored) return dark;
  const Vec3 view = normalized(ray.direction);
  const float fresnel = film.mirror * waterReflectance(-dot(view, hit.normal));
  return lerp(dark, smeared(ray, hit.t, film.normal, film.roughness), fresnel);
}

WaterFilm waterFilm(const Ground::Hit& hit, float width_m, const Scene& scene, int frame) {
  constexpr float kPavingEnd_m = 3.6F;  // as in Ground
  WaterFilm film{.normal = hit.normal};
  if (hit.curb_face || hit.where.outside_m > kPavingEnd_m || (scene.meadow && hit.where.outside_m > 0)) {
    film.darkening = 0.75F;  // wet stone or grass, no closed film
    return film;
  }
  const float x = hit.position_map.x, y = hit.position_map.y;
  const bool road = hit.where.outside_m < 0;
  const std::uint32_t seed = scene.seed * 131U;
  // Water gathers in hollows, and along the curb.
  const float gutter = road ? 0.5F * saturate(1 + hit.where.outside_m / 0.9F) : 0;
  const float hollow = fractal2(x, y, {3.1F, 4, 0.55F}, width_m, seed) + gutter;
  const float puddle = saturate((hollow - 0.25F) / 0.2F);
  film.darkening = road ? lerp(0.42F, 0.30F, puddle) : lerp(0.6F, 0.5F, puddle);
  film.mirror = lerp(road ? 0.75F : 0.5F, 1, puddle);
  film.roughness = lerp(road ? 0.035F : 0.05F, 0.003F, puddle);
  const float film_slope = 0.02F * (1 - puddle), ring_slope = 0.012F * puddle;
  const auto slope = [&](std::uint32_t salt) {
    return film_slope * fractal2(x, y, {0.6F, 4, 0.8F}, width_m, seed + 10 + salt) +
           ring_slope * fractal2(x, y, {0.12F, 2, 0.8F}, width_m, hashOf(frame, static_cast<int>(salt), seed));
  };
  film.normal = normalized({slope(1), slope(2), 1});
  return film;
}

float waterReflectance(float cosine) {
  constexpr float kHeadOn = 0.02F;  // refractive index 1.33
  const float rest = saturate(1 - cosine);
  return kHeadOn + (1 - kHeadOn) * rest * rest * rest * rest * rest;
}

}  // namespace motorcade::synth
