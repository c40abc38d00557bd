#include "apps/synth/textures/texture_strokes.hpp"

namespace motorcade::synth {

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

float wheelDistance(const Model& model, const Vec3& p) {
  float nearest = 1e9F;
  for (const auto& part : model.parts) {
    if (part.material != Material::kTire) continue;
    const Vec3 c = (part.lo + part.hi) * 0.5F;
    nearest = std::fmin(nearest, std::hypot(p.x - c.x, p.z - c.z) - 0.5F * (part.hi.z - part.lo.z));
  }
  return nearest;
}

}  // namespace motorcade::synth
