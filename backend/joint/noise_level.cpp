#include "backend/joint/noise_level.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {

NoiseLevel NoiseLevel::like(const NoiseLevel& known) {
  NoiseLevel level;
  level.first_uv2_ = known.uv() * known.uv();
  level.first_d2_ = known.d() * known.d();
  return level;
}

void NoiseLevel::learn(const ResidualLevels& levels) {
  constexpr double kMemory = 4000;  // observations
  const double keep = std::max(0.0, 1 - levels.d_count / kMemory), mean_square = LandmarkNoise{}.meanSquare();
  const double uv2 = uv() * uv() / mean_square, d2 = d() * d() / mean_square;
  sums_.uv_sum = keep * sums_.uv_sum + uv2 * levels.uv_sum;
  sums_.uv_count = keep * sums_.uv_count + levels.uv_count;
  sums_.d_sum = keep * sums_.d_sum + d2 * levels.d_sum;
  sums_.d_count = keep * sums_.d_count + levels.d_count;
  sums_.common_sum = keep * sums_.common_sum + levels.common_sum;
  sums_.successive_sum = keep * sums_.successive_sum + levels.successive_sum;
  residual_sum_ = keep * residual_sum_ + levels.uv_sum + levels.d_sum;
}

double NoiseLevel::designEffect() const {
  constexpr double kPrior = 300;  // squared residuals that are independent
  constexpr double kMostCorrelation = 0.8;
  const double all = kPrior + residual_sum_, common = (kPrior + sums_.common_sum) / all;
  const double correlation = std::clamp(sums_.successive_sum / all, 0.0, kMostCorrelation);
  return std::max(1.0, common) * (1 + correlation) / (1 - correlation);
}

double NoiseLevel::uv() const {
  constexpr double kPrior = 100;
  return std::sqrt((kPrior * first_uv2_ + sums_.uv_sum) / (kPrior + sums_.uv_count));
}

double NoiseLevel::d() const {
  constexpr double kPrior = 50;
  return std::sqrt((kPrior * first_d2_ + sums_.d_sum) / (kPrior + sums_.d_count));
}

}  // namespace motorcade
