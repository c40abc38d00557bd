#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "core/se3.hpp"

namespace motorcade::perf {

/// Standard deviations of a measured motion, the same along all axes.
struct MotionSigma {
  double m, rad;
};

/// Measurements of one frame, and the camera's true pose.
struct SimulatedFrame {
  struct Object {
    bool is_new;  // takes the slot of one that is gone
    SE3 T_cam_body;
    SE3 T_before_now;  // its motion since the frame before; not of a new one
  };
  SE3 T_world_cam;              // true
  SE3 T_previous_now;           // odometry
  std::vector<Object> objects;  // a slot keeps its object until it is gone
  std::vector<SE3> encounters;  // the pose of the object in slot 2 i + 1 from the one in slot 2 i
};

/// A camera on an endless winding road, with a given number of vehicles in view: each drives along for 60 to 200
/// frames, then another replaces it. Ten frames a second, about a meter per frame. Seeded.
class MultibodyScene {
 public:
  static constexpr double kFrame_s = 0.1;
  static constexpr int kMinLifeFrames = 60, kMaxLifeFrames = 200;
  static constexpr MotionSigma kOdometry{0.02, 0.00087}, kObjectMotion{0.05, 0.0087}, kCameraEncounter{0.1, 0.0175},
      kObjectEncounter{0.3, 0.05};

  MultibodyScene(int objects, std::uint64_t seed);
  SimulatedFrame next();

 private:
  struct Vehicle {
    double gap_m = 0, gap_swing_m = 0, swing_rad = 0, right_m = 0;
    int frames_left = 0;
    SE3 T_world_body;
  };

  double uniform(double from, double to);
  SE3 noise(const MotionSigma& sigma);
  Vehicle newVehicle();
  SE3 poseOf(const Vehicle& vehicle) const;
  SimulatedFrame::Object observed(Vehicle& vehicle);

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<Vehicle> vehicles_;
  std::int64_t frame_ = -1;
  SE3 T_world_cam_;
};

}  // namespace motorcade::perf
