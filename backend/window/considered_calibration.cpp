#include "backend/window/considered_calibration.hpp"

namespace motorcade {

ConsideredCalibration::PoseShifts ConsideredCalibration::ofMotion(FrameId before, FrameId now) const {
  PoseShifts shifts = PoseShifts::Zero();
  SE3 T_step_now;
  for (auto it = steps_.upper_bound(now); it != steps_.begin() && (--it)->first > before;) {
    shifts += T_step_now.inverse().adjoint() * it->second.shifts;
    T_step_now = it->second.T_before_now * T_step_now;
  }
  return shifts;
}

ConsideredCalibration::PointShifts ConsideredCalibration::ofPoint(const Eigen::Vector3d& p_cam) const {
  const auto uvd_px = camera_ ? camera_->project(p_cam) : std::nullopt;
  if (!uvd_px) return PointShifts::Zero();
  return camera_->triangulationJacobian(*uvd_px) * observationShifts(*camera_, sigmas_, *uvd_px);
}

/// v = p' + w x p + c, with the camera's twist (c, w): each term shifts.
ConsideredCalibration::PointShifts ConsideredCalibration::ofVelocity(FrameId frame, const Eigen::Vector3d& p_cam,
                                                                     const Eigen::Vector3d& velocity_cam_mps) const {
  const auto known = steps_.find(frame);
  if (known == steps_.end() || known->second.seconds <= 0) return PointShifts::Zero();
  const Step& step = known->second;
  const PoseShifts of_twist = step.shifts / step.seconds;
  const Vector6d twist = step.T_before_now.log() / step.seconds;
  const Eigen::Vector3d turn_radps = twist.tail<3>();
  const Eigen::Vector3d seen_mps = velocity_cam_mps - twist.head<3>() - turn_radps.cross(p_cam);
  const Eigen::Vector3d half_way = seen_mps * step.seconds / 2;
  const PointShifts of_seen = (ofPoint(p_cam + half_way) - ofPoint(p_cam - half_way)) / step.seconds;
  return of_seen + hat(turn_radps) * ofPoint(p_cam) + of_twist.topRows<3>() - hat(p_cam) * of_twist.bottomRows<3>();
}

}  // namespace motorcade
