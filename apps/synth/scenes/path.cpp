#include "apps/synth/scenes/path.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade::synth {
namespace {

double ease(double t) { return t * t * t * (10 + t * (6 * t - 15)); }
double easeSlope(double t) { return 30 * t * t * (1 - t) * (1 - t); }
double easeIntegral(double t) { return t * t * t * t * (2.5 + t * (t - 3)); }

/// Curvature of the pieces at s: each arc rises and falls over `kEase_m`, with the arc's whole turn kept.
double curvatureAt(double s, const std::vector<Path::Piece>& pieces) {
  constexpr double kEase_m = 5;
  double start = 0, curvature = 0;
  for (const auto& piece : pieces) {
    const double end = start + piece.length_m;
    const auto step = [&](double border) { return ease(std::clamp((s - border) / kEase_m + 0.5, 0.0, 1.0)); };
    if (piece.turn_rad != 0) curvature += piece.turn_rad / piece.length_m * (step(start) - step(end));
    start = end;
  }
  return curvature;
}

}  // namespace

double Profile::operator()(double at) const {
  if (at <= knots_.front().at) return knots_.front().value;
  for (std::size_t i = 1; i < knots_.size(); ++i) {
    const Knot &a = knots_[i - 1], &b = knots_[i];
    if (at < b.at) return a.value + (b.value - a.value) * ease((at - a.at) / (b.at - a.at));
  }
  return knots_.back().value;
}

double Profile::slope(double at) const {
  for (std::size_t i = 1; i < knots_.size(); ++i) {
    const Knot &a = knots_[i - 1], &b = knots_[i];
    if (at > a.at && at < b.at) return (b.value - a.value) / (b.at - a.at) * easeSlope((at - a.at) / (b.at - a.at));
  }
  return 0;
}

double Profile::integral(double to) const {
  double sum = knots_.front().value * std::min(to, knots_.front().at);
  for (std::size_t i = 1; i < knots_.size() && to > knots_[i - 1].at; ++i) {
    const Knot &a = knots_[i - 1], &b = knots_[i];
    const double span = b.at - a.at, t = std::min(1.0, (to - a.at) / span);
    sum += span * (a.value * t + (b.value - a.value) * easeIntegral(t));
  }
  return sum + knots_.back().value * std::max(0.0, to - knots_.back().at);
}

Path::Path(const Eigen::Vector2d& start, double heading_rad, const std::vector<Piece>& pieces, bool closed)
    : closed_(closed) {
  for (const auto& piece : pieces) length_m_ += piece.length_m;
  const auto steps = static_cast<std::size_t>(std::ceil(length_m_ / kStep_m));
  step_m_ = length_m_ / static_cast<double>(steps);
  constexpr int kSubsteps = 50;
  const double h = step_m_ / kSubsteps;
  Point point{start, heading_rad, curvatureAt(0, pieces)};
  samples_.push_back(point);
  for (std::size_t i = 0; i < steps; ++i) {
    for (int k = 0; k < kSubsteps; ++k) {  // midpoint rule
      const double s = static_cast<double>(i) * step_m_ + (k + 0.5) * h;
      const double middle = point.heading_rad + 0.5 * h * point.curvature_per_m;
      point.position += h * Eigen::Vector2d(std::cos(middle), std::sin(middle));
      point.heading_rad += h * curvatureAt(s, pieces);
      point.curvature_per_m = curvatureAt(s + 0.5 * h, pieces);
    }
    samples_.push_back(point);
  }
  if (!closed_) return;
  // Spread what the integration misses (micrometers) over the lap.
  const Eigen::Vector2d gap = samples_.front().position - samples_.back().position;
  for (std::size_t i = 0; i <= steps; ++i)
    samples_[i].position += gap * (static_cast<double>(i) / static_cast<double>(steps));
}

Path::Point Path::at(double s_m) const {
  double turns = 0;
  if (closed_) {
    turns = std::floor(s_m / length_m_);
    s_m -= turns * length_m_;
  }
  const double inside_m = std::clamp(s_m, 0.0, length_m_);
  const auto i = std::min(static_cast<std::size_t>(inside_m / step_m_), samples_.size() - 2);
  const Point &a = samples_[i], &b = samples_[i + 1];
  const double t = inside_m / step_m_ - static_cast<double>(i), h = step_m_;
  // Cubic Hermite in position and heading.
  const double h00 = (1 + 2 * t) * (1 - t) * (1 - t), h10 = t * (1 - t) * (1 - t), h01 = t * t * (3 - 2 * t),
               h11 = t * t * (t - 1);
  Point point;
  point.position = h00 * a.position + h10 * h * a.along() + h01 * b.position + h11 * h * b.along();
  point.heading_rad =
      h00 * a.heading_rad + h10 * h * a.curvature_per_m + h01 * b.heading_rad + h11 * h * b.curvature_per_m;
  point.curvature_per_m = a.curvature_per_m + t * (b.curvature_per_m - a.curvature_per_m);
  point.heading_rad += turns * (samples_.back().heading_rad - samples_.front().heading_rad);
  point.position += (s_m - inside_m) * point.along();
  return point;
}

}  // namespace motorcade::synth
