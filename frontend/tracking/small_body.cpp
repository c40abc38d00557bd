#include "frontend/tracking/small_body.hpp"

#include "core/elementary.hpp"

namespace motorcade {

bool mayBeSmall(const TrackedObject& object) {
  constexpr double kFastest_mps = 8;  // on a bicycle
  constexpr double kLongest_m = 2;    // a bicycle, and the diagonal of who walks beside one
  if (object.kinematics.speed_mps() > kFastest_mps) return false;
  const Eigen::Vector3d size_m = object.core(SE3{}).sizes();
  return hypotenuse(size_m.x(), size_m.y()) < kLongest_m;
}

bool mayBeWalking(const TrackedObject& object, const StereoCamera& camera) {
  constexpr double kSlowest_mps = 0.5, kFastest_mps = 3;  // who runs for a bus
  constexpr double kBehind_m = 0.5, kSigma_px = 0.3;      // of a patch's disparity
  const double speed_mps = object.kinematics.speed_mps(), z_m = object.T_cam_body.translation().z();
  if (speed_mps < kSlowest_mps || speed_mps > kFastest_mps) return false;
  return camera.fx_px * camera.baseline_m * kBehind_m > kSigma_px * z_m * z_m && mayBeSmall(object);
}

}  // namespace motorcade
