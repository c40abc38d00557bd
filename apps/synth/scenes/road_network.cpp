#include "apps/synth/scenes/road_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace motorcade::synth {
namespace {

/// Arc length and left offset of a point.
struct Foot {
  double s_m, left_m;
  int sample;
};

/// The foot on the circle that osculates the path at a sample, moved on to the sample that is nearest to it.
Foot footOnPath(const Path& path, double step_m, int sample, const Eigen::Vector2d& p,
                const std::vector<Eigen::Vector2d>& along) {
  Foot foot{0, 0, sample};
  const int last = static_cast<int>(path.samples().size()) - 1;
  for (int i = 0; i < 8; ++i) {
    const auto& point = path.samples()[foot.sample];
    const Eigen::Vector2d& direction = along[foot.sample];
    const Eigen::Vector2d offset = p - point.position;
    const double ahead = offset.dot(direction), left = direction.x() * offset.y() - direction.y() * offset.x();
    foot.s_m = ahead;
    foot.left_m = left;
    if (std::abs(point.curvature_per_m) > 1e-6) {
      const double radius = 1 / point.curvature_per_m;  // signed
      foot.s_m = radius * std::atan(ahead / (radius - left));
      foot.left_m = radius - std::copysign(std::hypot(ahead, radius - left), radius);
    }
    const int move = static_cast<int>(std::lround(foot.s_m / step_m));
    foot.s_m += foot.sample * step_m;
    const int next = std::clamp(foot.sample + move, 0, last);
    if (next == foot.sample || point.curvature_per_m == 0) break;
    foot.sample = next;
  }
  return foot;
}

}  // namespace

RoadNetwork::RoadNetwork(std::vector<Road> roads) : roads_(std::move(roads)), along_(roads_.size()) {
  Eigen::Vector2d lo(1e9, 1e9), hi(-1e9, -1e9);
  for (const auto& road : roads_)
    for (const auto& point : road.path->samples()) {
      lo = lo.cwiseMin(point.position);
      hi = hi.cwiseMax(point.position);
    }
  origin_x_m_ = lo.x() - kReach_m;
  origin_y_m_ = lo.y() - kReach_m;
  columns_ = static_cast<int>((hi.x() - lo.x() + 2 * kReach_m) / kCell_m) + 1;
  rows_ = static_cast<int>((hi.y() - lo.y() + 2 * kReach_m) / kCell_m) + 1;
  cells_.resize(columns_ * rows_);
  std::vector<double> nearest(cells_.size());
  const int reach = static_cast<int>(kReach_m / kCell_m);
  for (int r = 0; r < static_cast<int>(roads_.size()); ++r) {
    std::fill(nearest.begin(), nearest.end(), std::numeric_limits<double>::max());
    const auto& samples = roads_[r].path->samples();
    for (const auto& point : samples) along_[r].push_back(point.along());
    for (int i = 0; i < static_cast<int>(samples.size()); i += 2) {
      const Eigen::Vector2d& p = samples[i].position;
      const int column = static_cast<int>((p.x() - origin_x_m_) / kCell_m),
                row = static_cast<int>((p.y() - origin_y_m_) / kCell_m);
      const auto keepIfNearest = [&](int x, int y) {
        const int index = y * columns_ + x;
        const double d2 =
            (p - Eigen::Vector2d(origin_x_m_ + (x + 0.5) * kCell_m, origin_y_m_ + (y + 0.5) * kCell_m)).squaredNorm();
        if (d2 >= nearest[index]) return;
        if (nearest[index] == std::numeric_limits<double>::max()) cells_[index].push_back({r, i});
        cells_[index].back().sample = i;
        nearest[index] = d2;
      };
      for (int y = std::max(0, row - reach); y <= std::min(rows_ - 1, row + reach); ++y)
        for (int x = std::max(0, column - reach); x <= std::min(columns_ - 1, column + reach); ++x) keepIfNearest(x, y);
    }
  }
}

RoadPosition RoadNetwork::locate(double x_m, double y_m) const {
  RoadPosition best;
  const int column = static_cast<int>(std::floor((x_m - origin_x_m_) / kCell_m)),
            row = static_cast<int>(std::floor((y_m - origin_y_m_) / kCell_m));
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return best;
  const Eigen::Vector2d p(x_m, y_m);
  for (const auto& candidate : cells_[row * columns_ + column]) {
    const Road& road = roads_[candidate.road];
    const double step = road.path->length_m() / static_cast<double>(road.path->samples().size() - 1);
    const auto& along = along_[candidate.road];
    const Foot foot = footOnPath(*road.path, step, candidate.sample, p, along);
    const double beyond_end_m = road.path->closed() ? -1e9 : std::max(-foot.s_m, foot.s_m - road.path->length_m());
    const auto outside = static_cast<float>(std::max(std::abs(foot.left_m) - road.half_width_m, beyond_end_m));
    if (outside >= best.outside_m) {
      best.next_outside_m = std::min(best.next_outside_m, outside);
      continue;
    }
    const Eigen::Vector2d& direction = along[foot.sample];
    best = {candidate.road, static_cast<float>(foot.s_m),      static_cast<float>(foot.left_m),  outside,
            best.outside_m, static_cast<float>(direction.x()), static_cast<float>(direction.y())};
  }
  return best;
}

}  // namespace motorcade::synth
