#include "frontend/tracking/point_adoption.hpp"

#include <cmath>

#include "frontend/tracking/vehicle_size.hpp"

namespace motorcade {
namespace {

constexpr double kMargin_m = 0.8;          // beyond the points known so far, in which others may join
constexpr double kDepthNoiseSigmas = 2.0;  // by which the margin grows
constexpr double kFitsChi2 = 9.0;          // of a velocity to the body's; 3 degrees of freedom: 97 %
constexpr double kNotStaticChi2 = 16.0;  // by which a moving point explains the track better than one at rest: 4 sigma
constexpr double kMinSpeed_mps = 1.0;    // slower objects cannot be told from the background by motion
/// A point whose place is known less well may be on anything, and would stretch the object's extent without end.
constexpr double kMostSlack_m = kLongestVehicle.length_m;

/// Close to the points known so far: a long vehicle is found step by step. Points of a segment that was matched to the
/// object need no neighbors within the size of an ordinary vehicle.
bool isWithinReach(const Eigen::AlignedBox3d& known, const BodyPoint& candidate, bool matched) {
  const double slack_m = kDepthNoiseSigmas * std::sqrt(candidate.covariance.trace());
  if (slack_m > kMostSlack_m) return false;
  const Eigen::AlignedBox3d grown = Eigen::AlignedBox3d(known).extend(candidate.p_body);
  Eigen::AlignedBox3d near = known;
  near.min().array() -= kMargin_m;
  near.max().array() += kMargin_m;
  const bool close = near.exteriorDistance(candidate.p_body) < slack_m;
  return (close && kLongestVehicle.holds(grown, slack_m)) || (matched && kOrdinaryVehicle.holds(grown, slack_m));
}

bool mayMove(const ScenePoint& point) {
  return point.flow && point.flow->static_chi2 - point.flow->moving_chi2 > kNotStaticChi2;
}

}  // namespace

/// A point that moves, and with the body's velocity there. What is told by a glance is asked first.
void PointAdoption::operator()(TrackedObject& object, const SceneMotion& scene, const Segment* segment,
                               const SE3& T_world_cam, std::vector<bool>& taken) const {
  if (object.kinematics.speed_mps() < kMinSpeed_mps) return;
  const Eigen::AlignedBox3d known = object.extent(0);
  std::vector<BodyPoint> adopted;
  const auto consider = [&](int i) {
    const ScenePoint& p = scene.points[i];
    if (taken[i] || p.ambiguous || p.label == PointLabel::kGround || !mayMove(p)) return;
    const BodyPoint candidate = toBody(p, object.T_cam_body, camera_);
    if (!isWithinReach(known, candidate, segment != nullptr)) return;
    if (object.velocityChi2(*p.flow, T_world_cam) >= kFitsChi2) return;
    taken[i] = true;
    adopted.push_back(candidate);
  };
  if (segment) {
    for (const int i : segment->points) consider(i);
  } else {
    for (int i = 0; i < static_cast<int>(scene.points.size()); ++i) consider(i);
  }
  object.adopt(adopted);
}

}  // namespace motorcade
