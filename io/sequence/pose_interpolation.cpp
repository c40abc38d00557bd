#include "io/sequence/pose_interpolation.hpp"

#include <algorithm>

namespace motorcade {

SE3 poseAt(Timestamp stamp, const std::vector<SE3>& poses, const std::vector<Timestamp>& stamps) {
  const auto after = std::ranges::upper_bound(stamps, stamp) - stamps.begin();
  const std::size_t i = std::clamp<std::ptrdiff_t>(after - 1, 0, std::ssize(stamps) - 2);
  const double part = secondsBetween(stamps[i], stamp) / secondsBetween(stamps[i], stamps[i + 1]);
  const auto &from = poses[i], &to = poses[i + 1];
  return {from.rotation() * expSO3(part * logSO3(from.rotation().transpose() * to.rotation())),
          from.translation() + part * (to.translation() - from.translation())};
}

}  // namespace motorcade
