#include "backend/smoother/estimate_reader.hpp"

#include <array>

namespace motorcade {
namespace {

using Matrix6x18d = Eigen::Matrix<double, 6, 18>;

/// Twist in the body's axes between two poses [m/s, rad/s].
Vector6d twist(const SE3& T_world_before, const SE3& T_world_after, double dt_s) {
  return (T_world_before.inverse() * T_world_after).log() / dt_s;
}

}  // namespace

void EstimateReader::refreshCovariances(FrameId frame) {
  CameraRecord& camera = graph_.frames().at(frame);
  if (const auto covariance = cameraCovariance(frame)) camera.covariance = covariance;
  for (auto& [id, track] : graph_.tracks()) {
    const auto record = track.records.find(frame);
    if (record != track.records.end() && record->second.z.valid()) refreshObject(track, record->second);
  }
}

std::optional<Matrix6d> EstimateReader::cameraCovariance(FrameId frame) const {
  const auto now = graph_.frames().find(frame),
             before = graph_.frames().find(FrameId{frame.value - params_.camera_covariance_frames});
  if (before == graph_.frames().end()) return std::nullopt;
  const std::array variables{before->second.x, now->second.x};
  const auto joint = graph_.solver().jointCovariance(variables);
  if (!joint) return std::nullopt;
  // x_b^-1 x_n with both perturbed: exp(-Ad(T_n_b) xi_b + xi_n)
  const SE3 T_before_now = graph_.solver().pose(before->second.x).inverse() * graph_.solver().pose(now->second.x);
  Eigen::Matrix<double, 6, 12> J;
  J << -T_before_now.inverse().adjoint(), Matrix6d::Identity();
  return J * *joint * J.transpose();
}

void EstimateReader::refreshObject(const ObjectTrack& track, ObjectRecord& record) const {
  const IncrementalSolver& solver = graph_.solver();
  const VariableId x = graph_.frames().at(record.seen.frame).x;
  // The neighbor in time, for the speed.
  const ObjectRecord* other = nullptr;
  const auto at = track.records.find(record.seen.frame);
  if (at != track.records.begin() && std::prev(at)->second.z.valid())
    other = &std::prev(at)->second;
  else if (std::next(at) != track.records.end() && std::next(at)->second.z.valid())
    other = &std::next(at)->second;
  std::vector<VariableId> variables{x, track.anchor, record.z};
  if (other) variables.push_back(other->z);
  const auto joint = solver.jointCovariance(variables);
  if (!joint) return;

  // x^-1 a z: exp(-Ad(T_body_cam) xi_x + Ad(z^-1) xi_a + xi_z)
  const SE3 z = solver.pose(record.z);
  const SE3 T_body_cam = (solver.pose(track.anchor) * z).inverse() * solver.pose(x);
  Matrix6x18d J;
  J << -T_body_cam.adjoint(), z.inverse().adjoint(), Matrix6d::Identity();
  record.covariance = J * joint->topLeftCorner<18, 18>() * J.transpose();
  if (!other) return;

  // Speed = |rho| / dt with (rho, phi) = log(z_other^-1 z).
  const SE3 T_other_now = solver.pose(other->z).inverse() * z;
  const Vector6d step = T_other_now.log();
  const Matrix6d J_now = rightJacobianInverseSE3(step);
  Eigen::Matrix<double, 6, 12> J_step;
  J_step << J_now, -J_now * T_other_now.inverse().adjoint();
  const Eigen::Matrix3d variance =
      (J_step * joint->bottomRightCorner<12, 12>() * J_step.transpose()).topLeftCorner<3, 3>();
  const double dt_s = std::abs(secondsBetween(other->stamp, record.stamp)), length_m = step.head<3>().norm();
  const Eigen::Vector3d direction =
      length_m > 1e-9 ? Eigen::Vector3d(step.head<3>() / length_m) : Eigen::Vector3d::UnitX();
  if (dt_s > 0) record.speed_sigma_mps = std::sqrt(direction.dot(variance * direction)) / dt_s;
}

FrameEstimate EstimateReader::read(FrameId frame) const {
  const CameraRecord& camera = graph_.frames().at(frame);
  FrameEstimate estimate{.frame = frame,
                         .stamp = camera.stamp,
                         .status = camera.status,
                         .T_world_cam = graph_.solver().pose(camera.x).normalized(),
                         .camera_covariance = camera.covariance,
                         .objects = {}};
  for (const auto& [id, track] : graph_.tracks())
    if (track.records.contains(frame)) estimate.objects.push_back(readObject(id, track, frame));
  return estimate;
}

ObjectEstimate EstimateReader::readObject(TrackId id, const ObjectTrack& track, FrameId frame) const {
  constexpr double kUnknownSpeedSigma_mps = 10.0;  // of a single observation
  const ObjectRecord& record = track.records.at(frame);
  return {.track = id,
          .state = record.seen.state,
          .T_world_body = graph_.objectPose(track, frame),
          .velocity_world_mps = velocity(track, frame),
          .speed_sigma_mps = record.speed_sigma_mps.value_or(kUnknownSpeedSigma_mps),
          .points = record.seen.points,
          .box = record.seen.box,
          .covariance = record.covariance};
}

/// Mean of the body twists to the poses before and after, as far as there are any: exact on arcs of constant speed.
Eigen::Vector3d EstimateReader::velocity(const ObjectTrack& track, FrameId frame) const {
  const auto now = track.records.find(frame);
  const SE3 T_world_body = graph_.objectPose(track, frame);
  Vector6d sum = Vector6d::Zero();
  int count = 0;
  const auto add = [&](const auto& before, const auto& after) {
    const double dt_s = secondsBetween(before->second.stamp, after->second.stamp);
    if (!(dt_s > 0)) return;
    sum += twist(graph_.objectPose(track, before->first), graph_.objectPose(track, after->first), dt_s);
    ++count;
  };
  if (now != track.records.begin()) add(std::prev(now), now);
  if (std::next(now) != track.records.end()) add(now, std::next(now));
  if (count == 0)
    return graph_.solver().pose(graph_.frames().at(frame).x).rotation() * now->second.seen.velocity_cam_mps;
  return T_world_body.rotation() * sum.head<3>() / count;
}

}  // namespace motorcade
