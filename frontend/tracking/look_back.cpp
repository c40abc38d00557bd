#include "frontend/tracking/look_back.hpp"

#include <utility>

#include <Eigen/LU>

namespace motorcade {

void LookBack::operator()(TrackedObject& object, Timestamp now, const ObjectKinematics::Params& kinematics) const {
  auto earlier = past_.rbegin();
  while (earlier != past_.rend() && earlier->scene->frame >= object.backlog.front().frame) ++earlier;
  for (int k = 0; k < frames_ && earlier != past_.rend(); ++k, ++earlier) {
    ObjectKinematics then = object.kinematics;
    then.predict(secondsBetween(now, earlier->scene->stamp), kinematics);
    auto observation = observe(object, *earlier, then);
    if (!observation) return;
    object.backlog.insert(object.backlog.begin(), std::move(*observation));
  }
}

std::optional<ObjectObservation> LookBack::observe(const TrackedObject& object, const PastScene& earlier,
                                                   const ObjectKinematics& then) const {
  const PosePrior prior{earlier.T_world_cam.inverse() * then.pose(), then.poseCovariance().inverse()};
  auto observation = motion_.lookBack(object, *earlier.scene, prior);
  if (!observation && then.positionSigma_m() < ObjectMotionEstimator::kMaxEvidenceSigma_m)
    observation = motion_.visibleEvidence(object, *earlier.scene, prior);
  if (!observation) return std::nullopt;
  observation->frame = earlier.scene->frame;
  observation->velocity_cam_mps = earlier.T_world_cam.rotation().transpose() * then.velocityWorld_mps();
  return observation;
}

void LookBack::remember(const SceneMotionPtr& scene, const SE3& T_world_cam) {
  past_.push_back({scene, T_world_cam});
  if (static_cast<int>(past_.size()) > kept_) past_.pop_front();
}

}  // namespace motorcade
