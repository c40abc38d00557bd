#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "core/se3.hpp"

namespace motorcade::synth {

/// A quantity over time or distance that eases between knots with two continuous derivatives and never overshoots.
class Profile {
 public:
  struct Knot {
    double at, value;
  };
  Profile(double constant = 0)
      : knots_{{0, constant}} {}  // NOLINT(google-explicit-constructor): a constant is a profile
  Profile(std::vector<Knot> knots) : knots_(std::move(knots)) {}  // NOLINT(google-explicit-constructor)

  double operator()(double at) const;
  double slope(double at) const;
  /// Integral from 0 to `to`.
  double integral(double to) const;

 private:
  std::vector<Knot> knots_;
};

/// A smooth plane curve by arc length: straights and arcs whose curvature eases over a few meters. Straight beyond its
/// ends unless closed, where it repeats.
class Path {
 public:
  struct Piece {
    double length_m, turn_rad;  // turns left when positive
  };
  struct Point {
    Eigen::Vector2d position;
    double heading_rad = 0, curvature_per_m = 0;
    Eigen::Vector2d along() const { return {std::cos(heading_rad), std::sin(heading_rad)}; }
    Eigen::Vector2d left() const { return {-std::sin(heading_rad), std::cos(heading_rad)}; }
  };
  Path(const Eigen::Vector2d& start, double heading_rad, const std::vector<Piece>& pieces, bool closed = false);

  Point at(double s_m) const;
  double length_m() const { return length_m_; }
  bool closed() const { return closed_; }
  static constexpr double kStep_m = 0.5;
  /// The points every `kStep_m`.
  const std::vector<Point>& samples() const { return samples_; }

 private:
  double length_m_ = 0, step_m_ = kStep_m;
  bool closed_ = false;
  std::vector<Point> samples_;
};

struct Model;

/// Motion along a path, at a speed and a lateral offset that ease between knots. Twice continuously differentiable. The
/// frame `map` is the scene's: z up, ground at z = 0.
struct Trajectory {
  std::shared_ptr<const Path> path;
  double start_m = 0;      // arc length at time 0
  bool backwards = false;  // drives against the path's direction
  Profile speed_mps;       // over time, never negative
  Profile left_m;          // offset to the path's left over the distance driven
  Profile up_m;            // height above the road, over the distance driven
  double sway_m = 0;       // a periodic drift along the path: sway_m * sin(2 pi t / sway_period_s + sway_phase_rad)
  double sway_period_s = 10, sway_phase_rad = 0;

  double distance_m(double t_s) const { return speed_mps.integral(t_s); }
  /// Arc length on the path.
  double arc_m(double t_s) const;
  double speedAt_mps(double t_s) const;
  /// Pose of the footprint's center: x ahead, y left, z up.
  SE3 T_map_body(double t_s) const;
};

/// The car that carries the camera: its trajectory plus the motion of its suspension, a few mm and tenths of a degree.
struct Ego {
  Trajectory trajectory;
  double camera_height_m = 1.65;
  /// Parts of the own car that both cameras see, fixed to the left one: x ahead, y left, z up. They are no object.
  std::shared_ptr<const Model> bonnet;
  double shake_period_s = 0;  // 0: never repeats; else every shake frequency fits this period
  /// Camera x right, y down, z ahead.
  SE3 T_map_cam(double t_s) const;
  SE3 T_map_bonnet(double t_s) const;
};

}  // namespace motorcade::synth
