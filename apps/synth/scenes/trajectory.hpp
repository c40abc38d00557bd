#pragma once

#include <memory>

#include "apps/synth/scenes/path.hpp"
#include "core/se3.hpp"

namespace motorcade::synth {

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
