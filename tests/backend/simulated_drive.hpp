#pragma once

#include <cmath>
#include <map>
#include <vector>

#include <Eigen/Cholesky>

#include "backend/backend.hpp"
#include "tests/backend/random_graphs.hpp"

namespace motorcade::test {

/// A camera drives along a gentle curve among vehicles on the ground, and measures all with noise of known covariance.
class SimulatedDrive {
 public:
  struct Vehicle {
    Eigen::Vector3d start_world;  // x right, y down, z ahead
    double heading_rad, speed_mps, turn_rate_radps;
    int first_frame, last_frame;
    double acceleration_mps2 = 0;  // along its path, whose curvature stays
  };
  struct Options {
    int frames = 60;
    std::vector<Vehicle> vehicles = {
        {{2, 1, 15}, 0, 9, 0.0, 0, 1000}, {{-4, 1, 30}, 0, 6, 0.15, 0, 1000}, {{4, 1, 25}, 0.2, 8, -0.05, 5, 45}};
    double dt_s = 0.1;
    double encounter_sigma_m = 0.25, encounter_sigma_rad = 0.03;
    double motion_sigma_m = 0.08, motion_sigma_rad = 0.01;
    double odometry_sigma_m = 0.02, odometry_sigma_rad = 0.002;
    int confirmed_after = 0;  // frames: observations up to then come with the confirmation
  };

  SimulatedDrive(std::uint64_t seed, const Options& options) : options_(options), random_(seed) {}

  Timestamp stamp(int frame) const { return {static_cast<std::int64_t>(frame * options_.dt_s * 1e9)}; }
  SE3 camera(int frame) const {
    Vector6d twist;
    twist << 0, 0, 8, 0, 0.03, 0;  // 8 m/s, turning slowly
    return SE3::exp(options_.dt_s * frame * twist);
  }
  /// Body axes: x ahead, y left, z up.
  SE3 object(std::size_t vehicle, int frame) const {
    const Vehicle& v = options_.vehicles[vehicle];
    Eigen::Matrix3d upright;  // columns: ahead = world z, left = -world x, up = -world y
    upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    Vector6d twist;
    twist << v.speed_mps, 0, 0, 0, 0, v.turn_rate_radps;
    const double t_s = options_.dt_s * (frame - v.first_frame);
    const double at_this_speed_s =
        v.acceleration_mps2 == 0 ? t_s : t_s * (1 + v.acceleration_mps2 * t_s / (2 * v.speed_mps));
    return SE3(expSO3({0, v.heading_rad, 0}) * upright, v.start_world) * SE3::exp(at_this_speed_s * twist);
  }
  bool visible(std::size_t vehicle, int frame) const {
    return frame >= options_.vehicles[vehicle].first_frame && frame <= options_.vehicles[vehicle].last_frame;
  }

  FrameMeasurementsPtr measure(int frame) {
    FrameMeasurements m;
    m.head.frame = {frame};
    m.head.stamp = stamp(frame);
    m.odometry.covariance = covariance(options_.odometry_sigma_m, options_.odometry_sigma_rad);
    if (frame > 0)
      m.odometry.T_previous_now = camera(frame - 1).inverse() * camera(frame) *
                                  random_.pose(options_.odometry_sigma_m, options_.odometry_sigma_rad);
    for (std::size_t v = 0; v < options_.vehicles.size(); ++v) {
      const int age = frame - options_.vehicles[v].first_frame;
      if (age == static_cast<int>(options_.vehicles[v].last_frame) - options_.vehicles[v].first_frame + 1)
        m.ended.push_back(track(v));
      if (!visible(v, frame)) continue;
      auto& backlog = backlog_[v];
      backlog.push_back(observe(v, frame));
      if (age < options_.confirmed_after) continue;
      m.objects.insert(m.objects.end(), backlog.begin(), backlog.end());
      backlog.clear();
    }
    return std::make_shared<const FrameMeasurements>(std::move(m));
  }

  static TrackId track(std::size_t vehicle) { return {static_cast<std::int64_t>(vehicle) + 100}; }
  static Matrix6d covariance(double sigma_m, double sigma_rad) {
    Vector6d variance;
    variance << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
    return variance.asDiagonal();
  }
  const Options& options() const { return options_; }

 private:
  ObjectObservation observe(std::size_t v, int frame) {
    ObjectObservation seen;
    seen.track = track(v);
    seen.frame = {frame};
    seen.points = 40;
    seen.T_cam_body = camera(frame).inverse() * object(v, frame) *
                      random_.pose(options_.encounter_sigma_m, options_.encounter_sigma_rad);
    seen.encounter_covariance = covariance(options_.encounter_sigma_m, options_.encounter_sigma_rad);
    if (frame > options_.vehicles[v].first_frame)
      seen.motion = {.since = {frame - 1},
                     .T_before_now = object(v, frame - 1).inverse() * object(v, frame) *
                                     random_.pose(options_.motion_sigma_m, options_.motion_sigma_rad),
                     .covariance = covariance(options_.motion_sigma_m, options_.motion_sigma_rad)};
    return seen;
  }

  Options options_;
  RandomPoses random_;
  std::map<std::size_t, std::vector<ObjectObservation>> backlog_;
};

/// All results of a back-end over a drive.
struct DriveResult {
  std::vector<FrameEstimate> online, finals;
  SolverCounters counters;
};

template <class Drive>
DriveResult runDrive(Backend& backend, Drive& drive) {
  DriveResult result;
  for (int i = 0; i < drive.options().frames; ++i) {
    const auto estimates = backend(drive.measure(i));
    result.online.push_back(estimates->online);
    result.finals.insert(result.finals.end(), estimates->finals.begin(), estimates->finals.end());
    result.counters = estimates->counters;
  }
  const auto rest = backend.finish();
  result.finals.insert(result.finals.end(), rest.begin(), rest.end());
  return result;
}

/// RMS position error of all objects seen from the camera's true frame of the start [m].
inline double objectError_m(const std::vector<FrameEstimate>& estimates, const SimulatedDrive& drive) {
  double sum = 0;
  int count = 0;
  for (const auto& frame : estimates)
    for (const auto& object : frame.objects) {
      const auto vehicle = static_cast<std::size_t>(object.track.value - 100);
      sum += (object.T_world_body.translation() -
              drive.object(vehicle, static_cast<int>(frame.head.frame.value)).translation())
                 .squaredNorm();
      ++count;
    }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

/// Error of the objects' published steps from frame to frame, RMS [m].
inline double stepError_m(const std::vector<FrameEstimate>& estimates, const SimulatedDrive& drive) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 1; i < estimates.size(); ++i)
    for (const auto& before : estimates[i - 1].objects)
      for (const auto& now : estimates[i].objects) {
        if (now.track != before.track) continue;
        const std::size_t vehicle = now.track.value - 100;
        const int frame = static_cast<int>(i);
        const SE3 truth = drive.object(vehicle, frame - 1).inverse() * drive.object(vehicle, frame);
        sum += (truth.inverse() * before.T_world_body.inverse() * now.T_world_body).translation().squaredNorm();
        ++count;
      }
  return std::sqrt(sum / count);
}

}  // namespace motorcade::test
