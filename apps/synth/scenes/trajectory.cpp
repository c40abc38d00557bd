#include "apps/synth/scenes/trajectory.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace motorcade::synth {
namespace {

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
