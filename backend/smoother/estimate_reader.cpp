#include "backend/smoother/estimate_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/fixed_product.hpp"

namespace motorcade {
namespace {

using Matrix6x12d = Eigen::Matrix<double, 6, 12>;
using Matrix6x18d = Eigen::Matrix<double, 6, 18>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;
using Matrix18d = Eigen::Matrix<double, 18, 18>;

/// Twist in the body's axes between two poses [m/s, rad/s].
Vector6d twist(const SE3& T_world_before, const SE3& T_world_after, double dt_s) {
  return (T_world_before.inverse() * T_world_after).log() / dt_s;
}

/// The pose of the same object before a frame's, else the one after it; null when the graph has neither.
const ObjectRecord* neighborInTime(const ObjectTrack& track, FrameId frame) {
  const auto now = track.records.find(frame);
  if (now != track.records.begin() && std::prev(now)->second.z.valid()) return &std::prev(now)->second;
  if (std::next(now) != track.records.end() && std::next(now)->second.z.valid()) return &std::next(now)->second;
  return nullptr;
}

/// Of the speed |rho| / dt and the yaw rate phi_z / dt with (rho, phi) = log(z_other^-1 z_now), from the joint
/// covariance of (z_now, z_other).
void addRateSigmas(FrameCovariances::Object& object, const SE3& T_other_now, const Eigen::Ref<const Matrix12d>& joint,
                   double dt_s) {
  if (!(dt_s > 0)) return;
  constexpr double kShortestStep_m = 1e-9;  // a shorter one has no direction
  const Vector6d step = T_other_now.log();
  const Matrix6d J_now = rightJacobianInverseSE3(step);
  Matrix6x12d J_step;
  J_step << J_now, -J_now * T_other_now.inverse().adjoint();
  const Matrix6d covariance = propagated(J_step, Matrix12d(joint));
  const double length_m = step.head<3>().norm();
  const Eigen::Vector3d direction =
      length_m > kShortestStep_m ? Eigen::Vector3d(step.head<3>() / length_m) : Eigen::Vector3d::UnitX();
  object.speed_sigma_mps = std::sqrt(direction.dot(covariance.topLeftCorner<3, 3>() * direction)) / dt_s;
  object.yaw_rate_sigma_radps = std::sqrt(std::max(0.0, covariance(5, 5))) / dt_s;
}

}  // namespace

FrameCovariances EstimateReader::covariances(FrameId frame) const {
  FrameCovariances covariances{.camera = cameraCovariance(frame), .objects = {}};
  for (const auto& [id, track] : graph_.tracks())
    if (auto object = objectCovariance(id, track, frame)) covariances.objects.push_back(*std::move(object));
  return covariances;
}

std::optional<Matrix6d> EstimateReader::cameraCovariance(FrameId frame) const {
  const auto now = graph_.frames().find(frame),
             after = graph_.frames().upper_bound(FrameId{frame.value - kCameraCovarianceFrames});
  if (after == graph_.frames().begin()) return std::nullopt;
  const auto before = std::prev(after);
  const std::array variables{before->second.x, now->second.x};
  const auto joint = graph_.solver().jointCovariance(variables);
  if (!joint) return std::nullopt;
  // x_b^-1 x_n with both perturbed: exp(-Ad(T_n_b) xi_b + xi_n)
  const SE3 T_before_now = graph_.solver().pose(before->second.x).inverse() * graph_.solver().pose(now->second.x);
  Matrix6x12d J;
  J << -T_before_now.inverse().adjoint(), Matrix6d::Identity();
  return propagated(J, Matrix12d(*joint));
}

std::optional<FrameCovariances::Object> EstimateReader::objectCovariance(TrackId id, const ObjectTrack& track,
                                                                         FrameId frame) const {
  const auto record = track.records.find(frame);
  if (record == track.records.end() || !record->second.z.valid()) return std::nullopt;
  const IncrementalSolver& solver = graph_.solver();
  const VariableId x = graph_.frames().at(frame).x;
  const ObjectRecord* other = neighborInTime(track, frame);
  std::vector<VariableId> variables{x, track.anchor, record->second.z};
  if (other) variables.push_back(other->z);
  const auto joint = solver.jointCovariance(variables);
  if (!joint) return std::nullopt;

  // x^-1 a z: exp(-Ad(T_body_cam) xi_x + Ad(z^-1) xi_a + xi_z)
  const SE3 z = solver.pose(record->second.z);
  const SE3 T_body_cam = (solver.pose(track.anchor) * z).inverse() * solver.pose(x);
  Matrix6x18d J;
  J << -T_body_cam.adjoint(), z.inverse().adjoint(), Matrix6d::Identity();
  FrameCovariances::Object object{.track = id,
                                  .T_cam_body = propagated(J, Matrix18d(joint->topLeftCorner<18, 18>())),
                                  .speed_sigma_mps = {},
                                  .yaw_rate_sigma_radps = {}};
  if (other)
    addRateSigmas(object, solver.pose(other->z).inverse() * z, joint->bottomRightCorner<12, 12>(),
                  std::abs(secondsBetween(other->stamp, record->second.stamp)));
  return object;
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
  constexpr double kUnknownSpeedSigma_mps = 10.0, kUnknownYawRateSigma_radps = 0.3;  // of a single observation
  const ObjectRecord& record = track.records.at(frame);
  const SE3 T_world_body = graph_.objectPose(track, frame);
  const Eigen::Matrix3d world_cam = graph_.solver().pose(graph_.frames().at(frame).x).rotation();
  const auto twist = meanTwist(track, frame);
  return {.track = id,
          .state = record.seen.state,
          .T_world_body = T_world_body,
          .velocity_world_mps = twist ? Eigen::Vector3d(T_world_body.rotation() * twist->head<3>())
                                      : Eigen::Vector3d(world_cam * record.seen.velocity_cam_mps),
          .speed_sigma_mps = record.speed_sigma_mps.value_or(kUnknownSpeedSigma_mps),
          .yaw_rate_radps = twist ? (*twist)[5] : 0,
          .yaw_rate_sigma_radps = record.yaw_rate_sigma_radps.value_or(kUnknownYawRateSigma_radps),
          .points = record.seen.points,
          .box = record.seen.box,
          .covariance = record.covariance};
}

/// Of the body twists to the poses before and after, as far as there are any: exact on arcs of constant speed.
std::optional<Vector6d> EstimateReader::meanTwist(const ObjectTrack& track, FrameId frame) const {
  const auto now = track.records.find(frame);
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
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace motorcade
