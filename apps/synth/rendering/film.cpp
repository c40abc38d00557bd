#include "apps/synth/rendering/film.hpp"

#include <cmath>
#include <numbers>

#include "apps/synth/shapes/noise.hpp"

namespace motorcade::synth {
namespace {

constexpr float kCornerLoss = 0.22F;  // of the level

/// Mean of three pixels in a row, weighted as a Gaussian of 0.6 px.
float soft(float before, float at, float after) {
  constexpr float kSide = 0.17F;
  return kSide * (before + after) + (1 - 2 * kSide) * at;
}

void blur(std::vector<float>& levels, int width, int height) {
  const std::vector<float> sharp = levels;
  std::vector<float> rows = levels;
  for (int y = 0; y < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      const int i = y * width + x;
      rows[i] = soft(sharp[i - 1], sharp[i], sharp[i + 1]);
    }
  levels = rows;
  for (int i = width; i < (height - 1) * width; ++i) levels[i] = soft(rows[i - width], rows[i], rows[i + width]);
}

/// A sine that fits the period, if there is one.
double wave(double time_s, double every_s, double period_s, std::uint32_t seed) {
  const double turns = period_s > 0 ? std::round(period_s / every_s) / period_s : 1 / every_s;
  return std::sin(2 * std::numbers::pi * (turns * time_s + static_cast<double>(unit(mix(seed)))));
}

/// Silver in clumps of a pixel or two, most of it in the middle tones.
void addGrain(std::vector<float>& levels, const FilmShot& shot) {
  constexpr float kGrain_levels = 3.2F, kSpacing_px = 1.6F;
  for (int y = 0; y < shot.height; ++y)
    for (int x = 0; x < shot.width; ++x) {
      const auto u = static_cast<float>(x), v = static_cast<float>(y);
      const float clumps = noise2(u / kSpacing_px, v / kSpacing_px, shot.grain_seed);
      const float fine = 2 * unit(hashOf(x, y, shot.grain_seed + 1)) - 1;
      float& level = levels[y * shot.width + x];
      const float tone = saturate(level / 255);
      level += kGrain_levels * (0.4F + 2.4F * tone * (1 - tone)) * (clumps + 0.6F * fine);
    }
}

}  // namespace

float veined(float reflectance, const Vec3& p, float footprint_m, std::uint32_t seed, float strength) {
  constexpr float kMiddle = 0.2F, kContrast = 0.8F, kMeanFold = 0.33F;
  float veins = 0, spacing_m = 0.9F, share = strength;
  for (std::uint32_t octave = 0; octave < 5; ++octave, spacing_m *= 0.47F, share *= 0.85F) {
    const float fold = std::abs(fractal3(p.x, p.y, p.z, {spacing_m, 1, 1}, footprint_m, seed + 97 + octave));
    veins += share * (kMeanFold * visible(spacing_m, footprint_m) - fold);
  }
  return kMiddle * std::pow(std::fmax(reflectance, 1e-3F) / kMiddle, kContrast) * std::fmax(0.2F, 1 + veins);
}

float exposureGain(const FilmShot& shot) {
  const auto at = [&](double every_s, std::uint32_t salt) {
    return wave(shot.time_s, every_s, shot.period_s, shot.scene_seed * 31U + salt);
  };
  const double gain = 1 + 0.10 * at(6.1, 1) + 0.05 * at(2.7, 2);
  return static_cast<float>(shot.right ? gain * (1 + 0.02 * at(9.3, 3) + 0.02 * at(4.3, 4)) : gain);
}

void develop(std::vector<float>& levels, const FilmShot& shot) {
  blur(levels, shot.width, shot.height);
  const float gain = exposureGain(shot), half_width = 0.5F * static_cast<float>(shot.width),
              half_height = 0.5F * static_cast<float>(shot.height);
  const float corner2 = half_width * half_width + half_height * half_height;
  for (int y = 0; y < shot.height; ++y)
    for (int x = 0; x < shot.width; ++x) {
      const float dx = static_cast<float>(x) - half_width, dy = static_cast<float>(y) - half_height;
      levels[y * shot.width + x] *= gain * (1 - kCornerLoss * (dx * dx + dy * dy) / corner2);
    }
  addGrain(levels, shot);
}

}  // namespace motorcade::synth
