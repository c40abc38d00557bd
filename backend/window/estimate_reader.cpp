#include "backend/window/estimate_reader.hpp"

#include <cmath>
#include <iterator>
#include <vector>

namespace motorcade {

FrameCovariances EstimateReader::covariances(FrameId frame) const {
  FrameCovariances covariances{.camera = cameraCovariances(frame), .objects = {}};
  for (const auto& [id, track] : window_.tracks())
    if (const auto object = this->covariances(track, frame)) covariances.objects.emplace(id, *object);
  return covariances;
}

std::optional<ObjectCovariances> EstimateReader::covariances(const ObjectTrack& track, FrameId frame) const {
  auto known = window_.objectCovariances(track, frame);
  if (known) consider(*known, track, frame);
  return known;
}

/// Adds the shifts of an object seen from the camera by errors of the calibration. That these also bend it a little is
/// left out.
void EstimateReader::consider(ObjectCovariances& known, const ObjectTrack& track, FrameId frame) const {
  const SE3 T_cam_world = window_.cameraPose(frame).inverse();
  const SE3 T_cam_body = T_cam_world * window_.objectPose(track, frame);
  const Eigen::Vector3d velocity_cam = T_cam_world.rotation() * window_.objectMotion(track, frame).velocity_world_mps;
  const ConsideredCalibration::PointShifts place =
      T_cam_body.rotation().transpose() * window_.calibration().ofPoint(T_cam_body.translation());
  known.T_cam_body.topLeftCorner<3, 3>() += place * place.transpose();
  if (!known.velocity_cam) return;
  const auto velocity = window_.calibration().ofVelocity(frame, T_cam_body.translation(), velocity_cam);
  *known.velocity_cam += velocity * velocity.transpose();
  if (known.speed_sigma_mps)
    known.speed_sigma_mps =
        std::hypot(*known.speed_sigma_mps, (velocity.transpose() * velocity_cam.stableNormalized()).norm());
}

std::optional<FrameId> EstimateReader::startOfMotion(FrameId frame) const {
  const auto after = window_.frames().upper_bound(FrameId{frame.value - motion_frames_});
  if (after == window_.frames().begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (before->second.part != window_.frames().at(frame).part) return std::nullopt;
  return before->first;
}

/// Covariances of the motion x_b^-1 x_n, with both perturbed, and of x_n. They are computed at once, as they need the
/// same cliques. The millimeter that the prior of the first pose leaves open is part of the latter.
///   x_b^-1 x_n -> exp(-Ad(T_n_b) xi_b + xi_n)
CameraCovariances EstimateReader::cameraCovariances(FrameId frame) const {
  const auto before = startOfMotion(frame);
  const CameraRecord& now = window_.frames().at(frame);
  const SE3 T_world_now = window_.cameraPose(frame);
  std::vector<VariableId> variables{now.x};
  Eigen::MatrixXd J = Matrix6d::Identity();
  if (before) {
    variables.insert(variables.begin(), window_.frames().at(*before).x);
    J.setIdentity(12, 12);
    J.topRows<6>() << -(T_world_now.inverse() * window_.cameraPose(*before)).adjoint(), Matrix6d::Identity();
  }
  CameraCovariances covariances;
  const auto joint = window_.solver().jointCovariance(variables, J);
  if (!joint) return covariances;
  const auto with = [&](const Matrix6d& covariance, const ConsideredCalibration::PoseShifts& shifts) -> Matrix6d {
    return window_.designEffect() * covariance + shifts * shifts.transpose();
  };
  const ConsideredCalibration& calibration = window_.calibration();
  if (before)
    covariances.motion = with(joint->topLeftCorner<6, 6>(), calibration.ofMotion(*before, frame, T_world_now));
  if (now.part == 0) covariances.pose = with(joint->bottomRightCorner<6, 6>(), calibration.ofPose(frame, T_world_now));
  return covariances;
}

FrameEstimate EstimateReader::read(FrameId frame) const {
  const CameraRecord& camera = window_.frames().at(frame);
  FrameEstimate estimate{.head = camera.head,
                         .T_world_cam = window_.cameraPose(frame).normalized(),
                         .camera_covariances = camera.covariances,
                         .objects = {}};
  for (const auto& [id, track] : window_.tracks())
    if (track.records.contains(frame)) estimate.objects.push_back(readObject(id, track, frame));
  return estimate;
}

ObjectEstimate EstimateReader::readObject(TrackId id, const ObjectTrack& track, FrameId frame) const {
  constexpr double kUnknownSpeedSigma_mps = 10.0, kUnknownYawRateSigma_radps = 0.3;  // of a single observation
  const ObjectRecord& record = track.records.at(frame);
  const ObjectMotionEstimate motion = window_.objectMotion(track, frame);
  ObjectEstimate estimate{.track = id,
                          .state = record.seen.state,
                          .T_world_body = window_.objectPose(track, frame),
                          .velocity_world_mps = motion.velocity_world_mps,
                          .speed_sigma_mps = kUnknownSpeedSigma_mps,
                          .velocity_covariance = {},
                          .yaw_rate_radps = motion.yaw_rate_radps,
                          .yaw_rate_sigma_radps = kUnknownYawRateSigma_radps,
                          .acceleration = {},
                          .points = record.seen.points,
                          .box = record.seen.box,
                          .covariance = {}};
  if (!record.covariances) return estimate;
  const ObjectCovariances& known = *record.covariances;
  estimate.covariance = known.T_cam_body;
  estimate.speed_sigma_mps = known.speed_sigma_mps.value_or(kUnknownSpeedSigma_mps);
  estimate.yaw_rate_sigma_radps = known.yaw_rate_sigma_radps.value_or(kUnknownYawRateSigma_radps);
  estimate.acceleration = known.acceleration;
  if (known.velocity_cam) {
    const Eigen::Matrix3d R_world_cam = window_.cameraPose(frame).rotation();
    estimate.velocity_covariance = R_world_cam * *known.velocity_cam * R_world_cam.transpose();
  }
  return estimate;
}

}  // namespace motorcade
