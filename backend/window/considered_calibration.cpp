#include "backend/window/considered_calibration.hpp"

#include <iterator>

namespace motorcade {

void ConsideredCalibration::set(FrameId now, const Step& step) {
  const auto first = steps_.insert_or_assign(now, KnownStep{.step = step}).first;
  for (auto it = first; it != steps_.end(); ++it)
    it->second.path = (it == steps_.begin() ? forgotten_path_ : std::prev(it)->second.path) +
                      it->second.step.T_world_now.adjoint() * it->second.step.shifts;
}

void ConsideredCalibration::forget(FrameId oldest) {
  forgotten_path_ = pathUpTo(oldest);
  steps_.erase(steps_.begin(), steps_.upper_bound(oldest));
}

const ConsideredCalibration::PoseShifts& ConsideredCalibration::pathUpTo(FrameId frame) const {
  const auto after = steps_.upper_bound(frame);
  return after == steps_.begin() ? forgotten_path_ : std::prev(after)->second.path;
}

ConsideredCalibration::PoseShifts ConsideredCalibration::ofMotion(FrameId before, FrameId now,
                                                                  const SE3& T_world_now) const {
  return T_world_now.inverse().adjoint() * (pathUpTo(now) - pathUpTo(before));
}

ConsideredCalibration::PoseShifts ConsideredCalibration::ofPose(FrameId now, const SE3& T_world_now) const {
  return T_world_now.inverse().adjoint() * pathUpTo(now);
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
  if (known == steps_.end() || known->second.step.seconds <= 0) return PointShifts::Zero();
  const Step& step = known->second.step;
  const PoseShifts of_twist = step.shifts / step.seconds;
  const Vector6d twist = step.T_before_now.log() / step.seconds;
  const Eigen::Vector3d turn_radps = twist.tail<3>();
  const Eigen::Vector3d seen_mps = velocity_cam_mps - twist.head<3>() - turn_radps.cross(p_cam);
  const Eigen::Vector3d half_way = seen_mps * step.seconds / 2;
  const PointShifts of_seen = (ofPoint(p_cam + half_way) - ofPoint(p_cam - half_way)) / step.seconds;
  return of_seen + hat(turn_radps) * ofPoint(p_cam) + of_twist.topRows<3>() - hat(p_cam) * of_twist.bottomRows<3>();
}

}  // namespace motorcade
