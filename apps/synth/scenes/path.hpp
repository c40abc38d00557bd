#pragma once

#include <vector>

#include <Eigen/Core>

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

}  // namespace motorcade::synth
