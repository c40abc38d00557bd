#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/messages.hpp"

namespace motorcade {

/// Two observations of one frame, by index.
using ObjectPair = std::pair<std::size_t, std::size_t>;

/// Pairs of objects, nearest first; no object has more than `max_partners`.
std::vector<ObjectPair> nearestPairs(std::span<const ObjectObservation* const> observations, double max_distance_m,
                                     int max_partners);

/// Relative pose T_m_n of two bodies seen by one camera. Its covariance (right perturbation) is from theirs, scaled.
struct RelativePose {
  SE3 T_m_n;
  Matrix6d covariance;
};
RelativePose relativePose(const ObjectObservation& m, const ObjectObservation& n, double variance_scale_m,
                          double variance_scale_n);

}  // namespace motorcade
