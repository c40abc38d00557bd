#include "apps/synth/textures/sky.hpp"

#include "apps/synth/shapes/noise.hpp"

namespace motorcade::synth {

float skyRadiance(const Vec3& direction, float pixel_rad, std::uint32_t seed, bool overcast) {
  const float azimuth = std::atan2(direction.y, direction.x), height = direction.z;
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
