#include "backend/pose_graph/object_pairs.hpp"

#include <algorithm>
#include <tuple>

namespace motorcade {

std::vector<ObjectPair> nearestPairs(std::span<const ObjectObservation* const> observations, double max_distance_m,
                                     int max_partners) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  for (std::size_t m = 0; m < observations.size(); ++m)
    for (std::size_t n = m + 1; n < observations.size(); ++n) {
      const double distance_m =
          (observations[m]->T_cam_body.translation() - observations[n]->T_cam_body.translation()).norm();
      if (distance_m <= max_distance_m) candidates.emplace_back(distance_m, m, n);
    }
  std::ranges::sort(candidates);
  std::vector<int> partners(observations.size(), 0);
  std::vector<ObjectPair> pairs;
  for (const auto& [distance_m, m, n] : candidates) {
    if (partners[m] >= max_partners || partners[n] >= max_partners) continue;
    ++partners[m], ++partners[n];
    pairs.emplace_back(m, n);
  }
  return pairs;
}

RelativePose relativePose(const ObjectObservation& m, const ObjectObservation& n, double variance_scale_m,
                          double variance_scale_n) {
  // (T_m exp(e_m))^-1 T_n exp(e_n) = T_m_n exp(e_n - Ad(T_n_m) e_m)
  const SE3 T_m_n = m.T_cam_body.inverse() * n.T_cam_body;
  const Matrix6d through = T_m_n.inverse().adjoint();
  return {T_m_n, variance_scale_n * n.encounter_covariance +
                     variance_scale_m * through * m.encounter_covariance * through.transpose()};
}

}  // namespace motorcade
