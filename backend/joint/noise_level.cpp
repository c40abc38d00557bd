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
  sums_.neighbor_sum = keep * sums_.neighbor_sum + levels.neighbor_sum;
  sums_.neighbor_count = keep * sums_.neighbor_count + levels.neighbor_count;
  sums_.views = keep * sums_.views + levels.views;
  sums_.successive_sum = keep * sums_.successive_sum + levels.successive_sum;
  residual_sum_ = keep * residual_sum_ + levels.uv_sum + levels.d_sum;
}

double NoiseLevel::designEffect(double neighbors_per_view) const {
  constexpr double kPrior = 300, kNeighborPrior = 3000;  // squared residuals, and products, that are independent
  constexpr double kMostCorrelation = 0.8;
  const double successive = std::clamp(sums_.successive_sum / (kPrior + residual_sum_), 0.0, kMostCorrelation);
  const double square = (kPrior + residual_sum_) / (kPrior / 3 + sums_.views);  // of a view's residual
  const double of_neighbors = std::max(0.0, sums_.neighbor_sum / (kNeighborPrior + sums_.neighbor_count) / square);
  return (1 + neighbors_per_view * of_neighbors) * (1 + successive) / (1 - successive);
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
