#include "apps/synth/rendering/renderer.hpp"

#include <array>
#include <atomic>
#include <functional>
#include <thread>

#include "apps/synth/rendering/film.hpp"
#include "apps/synth/rendering/ray_caster.hpp"
#include "apps/synth/shapes/noise.hpp"

namespace motorcade::synth {
namespace {

/// Bands of rows, handed to the threads as they come.
void parallelRows(int rows, int threads, const std::function<void(int)>& work) {
  constexpr int kBand = 8;
  std::atomic<int> next{0};
  const auto loop = [&] {
    for (int first = kBand * next++; first < rows; first = kBand * next++)
      for (int y = first; y < std::min(rows, first + kBand); ++y) work(y);
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < threads; ++i) helpers.emplace_back(loop);
  loop();
}

/// Gray level of linear light: a camera's square-root-like response.
float response(float light) { return 255 * std::sqrt(saturate(light * 0.98F)); }

/// Rays in a pixel besides the one through its center: point symmetric, so that no pixel leans to a side. The first two
/// serve alone where only the texture changes.
constexpr std::array<std::array<float, 2>, 4> kSpread{{{-0.4F, -0.2F}, {0.4F, 0.2F}, {-0.2F, 0.4F}, {0.2F, -0.4F}}};

struct Sensor {
  float gain, offset, noise_levels;
  std::uint32_t seed;

  std::uint8_t read(float level, int x, int y) const {
    const float sigma = noise_levels * std::sqrt(0.35F + 0.65F * level / 128);
    const float value = gain * level + offset + sigma * gaussian(hashOf(x, y, seed));
    return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
  }
};

/// Differs from image to image; laps repeat exactly.
std::uint32_t imageSeed(const FrameScene& frame, StereoSide side, std::uint32_t salt) {
  const Scene& scene = frame.scene();
  const int moment = scene.lap_frames > 0 ? frame.frame() % scene.lap_frames : frame.frame();
  return hashOf(moment, side == StereoSide::kRight ? 1 : 0, scene.seed + salt);
}

FilmShot filmShot(const FrameScene& frame, const StereoCamera& camera, StereoSide side) {
  const Scene& scene = frame.scene();
  return {.width = camera.width_px,
          .height = camera.height_px,
          .right = side == StereoSide::kRight,
          .time_s = scene.time_s(frame.frame()),
          .period_s = scene.frame_s * scene.lap_frames,
          .scene_seed = scene.seed,
          .grain_seed = imageSeed(frame, side, 57)};
}

Sensor sensorOf(const FrameScene& frame, StereoSide side, const RenderOptions& options) {
  const bool right = side == StereoSide::kRight;
  const std::uint32_t seed = imageSeed(frame, side, 31);
  const bool different = right && !options.equal_gains;
  return {different ? 1.02F : 1.0F, different ? -1.5F : 0.0F, options.noise_levels, seed};
}

/// Rays that a pixel needs besides the one through its center.
struct Refinement {
  std::size_t rays = 0;
  std::optional<Exposure> exposure;  // where the neighbors have it too
};

/// Compares a pixel with its neighbors: most rays where the surface or its shadow changes, some where the light does.
Refinement refinementOf(const std::vector<Sample>& samples, int width, int height, int x, int y) {
  constexpr float kContrast = 11;        // gray levels
  constexpr float kGroundContrast = 30;  // the ground's grain is filtered already: only shadows and paint count
  const auto at = [&](int i, int j) -> const Sample& {
    return samples[std::clamp(j, 0, height - 1) * width + std::clamp(i, 0, width - 1)];
  };
  const Sample& center = at(x, y);
  const bool ground = isLevelGround(center.surface);
  const float level = response(center.light), contrast = ground ? kGroundContrast : kContrast;
  bool same_surface = true, same_exposure = true, same_light = true;
  for (const auto [dx, dy] : {std::array{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const Sample& other = at(x + dx, y + dy);
    same_surface = same_surface && other.surface == center.surface;
    same_exposure = same_exposure && other.exposure == center.exposure;
    same_light = same_light && std::abs(response(other.light) - level) <= contrast;
  }
  Refinement refinement;
  if (same_exposure) refinement.exposure = center.exposure;
  if (!same_surface || (!same_light && (ground || !same_exposure)))
    refinement.rays = kSpread.size();
  else if (!same_light)
    refinement.rays = 2;
  return refinement;
}

/// Mean light of a pixel, by the rays through it.
float lightOf(const RayCaster& caster, const Sample& center, const Refinement& refinement, int x, int y) {
  const auto rays = static_cast<float>(refinement.rays + 1);
  float light = saturate(center.light);
  for (std::size_t i = 0; i < refinement.rays; ++i) {
    const auto [du, dv] = kSpread[i];
    light += saturate(
        caster.cast(static_cast<float>(x) + du, static_cast<float>(y) + dv, rays > 3 ? 1.6F : 1.3F, refinement.exposure)
            .light);
  }
  return light / rays;
}

}  // namespace

Rendering render(const FrameScene& frame, const StereoCamera& camera, StereoSide side, const RenderOptions& options) {
  const int width = camera.width_px, height = camera.height_px;
  const auto index = [width](int x, int y) { return y * width + x; };
  const RayCaster caster(frame, camera, side, options.style, options.errors);
  std::vector<Sample> samples(index(0, height));
  parallelRows(height, options.threads, [&](int y) {
    for (int x = 0; x < width; ++x)
      samples[index(x, y)] = caster.cast(static_cast<float>(x), static_cast<float>(y), 1, {});
  });
  Rendering out{ImagePool().acquire(width, height), std::vector<float>(samples.size()),
                std::vector<std::int16_t>(samples.size())};
  std::vector<float> levels(samples.size());
  parallelRows(height, options.threads, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const Sample& center = samples[index(x, y)];
      levels[index(x, y)] = response(lightOf(caster, center, refinementOf(samples, width, height, x, y), x, y));
      out.depth_m[index(x, y)] = center.depth_m;
      out.object[index(x, y)] = center.object;
    }
  });
  if (options.style == Style::kFilm) develop(levels, filmShot(frame, camera, side));
  const Sensor sensor = sensorOf(frame, side, options);
  parallelRows(height, options.threads, [&](int y) {
    for (int x = 0; x < width; ++x) out.image.mutableRow(y)[x] = sensor.read(levels[index(x, y)], x, y);
  });
  return out;
}

StereoCamera kittiCamera(int width_px, int height_px) {
  const double scale = width_px / 1242.0;
  return {721.5377 * scale,
          721.5377 * scale,
          (609.5593 + 0.5) * scale - 0.5,
          (172.854 + 0.5) * height_px / 375.0 - 0.5,
          0.5371657,
          width_px,
          height_px};
}

}  // namespace motorcade::synth
