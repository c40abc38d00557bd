#include "perf/backend/solver/multibody_scene.hpp"

#include <cmath>

namespace motorcade::perf {
namespace {

constexpr double kAdvance_m = 1.0;                   // along z, per frame
constexpr double kBend_m = 80, kBendLength_m = 150;  // x = bend sin(z / length)
constexpr double kSwingFrames = 150;                 // in which a vehicle falls back and catches up
constexpr MotionSigma kShake{0.01, 0.002};           // of the camera on its way

/// Pose on the road at z, `right_m` beside its middle, looking along it; axes as a camera's.
SE3 roadPose(double z, double right_m) {
  const double heading_rad = std::atan(kBend_m / kBendLength_m * std::cos(z / kBendLength_m));
  const Eigen::Matrix3d rotation = expSO3({0, heading_rad, 0});
  return {rotation, Eigen::Vector3d(kBend_m * std::sin(z / kBendLength_m), 0, z) + right_m * rotation.col(0)};
}

/// Axes of a body (x ahead, y left, z up) in those of the road.
SE3 bodyInRoadAxes() {
  Eigen::Matrix3d rotation;
  rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return {rotation, Eigen::Vector3d::Zero()};
}

}  // namespace

MultibodyScene::MultibodyScene(int objects, std::uint64_t seed) : random_(seed), vehicles_(objects) {}

double MultibodyScene::uniform(double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random_);
}

SE3 MultibodyScene::noise(const MotionSigma& sigma) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = normal_(random_) * (i < 3 ? sigma.m : sigma.rad);
  return SE3::exp(xi);
}

MultibodyScene::Vehicle MultibodyScene::newVehicle() {
  Vehicle vehicle;
  vehicle.gap_m = uniform(10, 50);
  vehicle.gap_swing_m = uniform(0, 4);
  vehicle.swing_rad = uniform(0, 6);
  vehicle.right_m = uniform(-8, 8);
  vehicle.frames_left = std::uniform_int_distribution<int>(kMinLifeFrames, kMaxLifeFrames)(random_);
  return vehicle;
}

SE3 MultibodyScene::poseOf(const Vehicle& vehicle) const {
  const double swing = std::sin(vehicle.swing_rad + 2 * M_PI * static_cast<double>(frame_) / kSwingFrames);
  const double gap_m = vehicle.gap_m + vehicle.gap_swing_m * swing;
  return roadPose(kAdvance_m * static_cast<double>(frame_) + gap_m, vehicle.right_m) * bodyInRoadAxes();
}

SimulatedFrame::Object MultibodyScene::observed(Vehicle& vehicle) {
  SimulatedFrame::Object object{.is_new = vehicle.frames_left == 0, .T_cam_body = {}, .T_before_now = {}};
  if (object.is_new) vehicle = newVehicle();
  --vehicle.frames_left;
  const SE3 before = vehicle.T_world_body;
  vehicle.T_world_body = poseOf(vehicle);
  object.T_cam_body = T_world_cam_.inverse() * vehicle.T_world_body * noise(kCameraEncounter);
  if (!object.is_new) object.T_before_now = before.inverse() * vehicle.T_world_body * noise(kObjectMotion);
  return object;
}

SimulatedFrame MultibodyScene::next() {
  ++frame_;
  const SE3 before = T_world_cam_;
  T_world_cam_ = roadPose(kAdvance_m * static_cast<double>(frame_), 0) * noise(kShake);
  SimulatedFrame frame{.T_world_cam = T_world_cam_,
                       .T_previous_now = before.inverse() * T_world_cam_ * noise(kOdometry),
                       .objects = {},
                       .encounters = {}};
  for (Vehicle& vehicle : vehicles_) frame.objects.push_back(observed(vehicle));
  for (std::size_t m = 0; m + 1 < vehicles_.size(); m += 2)
    frame.encounters.push_back(vehicles_[m].T_world_body.inverse() * vehicles_[m + 1].T_world_body *
                               noise(kObjectEncounter));
  return frame;
}

}  // namespace motorcade::perf
