#include "apps/synth/scenes/path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

constexpr double kTwoPi = 2 * std::numbers::pi;

struct Wave {
  double frequency_hz, amplitude, phase_rad;
};

/// Sum of the waves; frequencies are moved to multiples of 1 / period where a period is given.
template <std::size_t N>
double shake(const std::array<Wave, N>& waves, double t_s, double period_s) {
  double sum = 0;
  for (const auto& wave : waves) {
    const double f = period_s > 0 ? std::round(wave.frequency_hz * period_s) / period_s : wave.frequency_hz;
    sum += wave.amplitude * std::sin(kTwoPi * f * t_s + wave.phase_rad);
  }
  return sum;
}

Eigen::Matrix3d bodyFromCamera() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

constexpr std::array<Wave, 3> kPitch_rad{{{0.23, 0.0016, 0.3}, {0.71, 0.0012, 1.9}, {1.37, 0.0008, 4.0}}};
constexpr std::array<Wave, 2> kRoll_rad{{{0.31, 0.0014, 2.2}, {0.93, 0.0010, 0.7}}};
constexpr std::array<Wave, 2> kYaw_rad{{{0.17, 0.0012, 1.1}, {0.61, 0.0006, 3.3}}};
constexpr std::array<Wave, 3> kHeave_m{{{0.41, 0.006, 0.0}, {1.13, 0.005, 2.5}, {1.71, 0.003, 1.0}}};

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

double Trajectory::arc_m(double t_s) const {
  const double driven = distance_m(t_s) + sway_m * std::sin(kTwoPi * t_s / sway_period_s + sway_phase_rad);
  return start_m + (backwards ? -driven : driven);
}

double Trajectory::speedAt_mps(double t_s) const {
  const double omega = kTwoPi / sway_period_s;
  return speed_mps(t_s) + sway_m * omega * std::cos(omega * t_s + sway_phase_rad);
}

SE3 Trajectory::T_map_body(double t_s) const {
  const double driven = distance_m(t_s), left = left_m(driven), slope = left_m.slope(driven) * (backwards ? -1 : 1);
  const Path::Point point = path->at(arc_m(t_s));
  const Eigen::Vector2d position = point.position + left * point.left();
  const double heading =
      point.heading_rad + std::atan2(slope, 1 - point.curvature_per_m * left) + (backwards ? std::numbers::pi : 0);
  return {expSO3(Eigen::Vector3d(0, 0, heading)), Eigen::Vector3d(position.x(), position.y(), up_m(driven))};
}

SE3 Ego::T_map_cam(double t_s) const {
  const SE3 T_map_body = trajectory.T_map_body(t_s);
  const Eigen::Vector3d tilt(shake(kRoll_rad, t_s, shake_period_s), shake(kPitch_rad, t_s, shake_period_s),
                             shake(kYaw_rad, t_s, shake_period_s));
  const Eigen::Vector3d mount(0, 0, camera_height_m + shake(kHeave_m, t_s, shake_period_s));
  return (T_map_body * SE3(expSO3(tilt) * bodyFromCamera(), mount)).normalized();
}

SE3 Ego::T_map_bonnet(double t_s) const {
  return T_map_cam(t_s) * SE3(bodyFromCamera().transpose(), Eigen::Vector3d::Zero());
}

}  // namespace motorcade::synth
