#include "frontend/tracking/point_adoption.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/elementary.hpp"
#include "frontend/segmentation/rigid_parts.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/object_motion.hpp"
#include "frontend/tracking/see_through.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

constexpr double kMargin_m = 0.8;          // beyond the points known so far, in which others may join
constexpr double kDepthNoiseSigmas = 2.0;  // by which the margin grows
constexpr double kNotStaticChi2 = 16.0;  // by which a moving point explains the track better than one at rest: 4 sigma
constexpr double kMinSpeed_mps = 1.0;    // slower objects cannot be told from the background by motion
/// Largest depth noise of a point that may join: others may be on anything, and would stretch the object without end.
constexpr double kMostSlack_m = kLongestVehicle.length_m;

/// True when a candidate is close to the points known so far: a long vehicle is found step by step. Points of a
/// component that was matched to the object need no neighbors within the size of an ordinary vehicle. Far ahead a
/// candidate's noise lets the body be longer, not wider: it counts along each axis of the body.
bool isWithinReach(const Eigen::AlignedBox3d& known, const BodyPoint& candidate, bool matched) {
  const Eigen::Array3d slack_m = kDepthNoiseSigmas * candidate.covariance.diagonal().array().sqrt();
  const double reach_m = slack_m.matrix().norm();
  if (reach_m > kMostSlack_m) return false;
  const Eigen::AlignedBox3d grown = Eigen::AlignedBox3d(known).extend(candidate.p_body);
  Eigen::AlignedBox3d near = known;
  near.min().array() -= kMargin_m;
  near.max().array() += kMargin_m;
  const bool close = near.exteriorDistance(candidate.p_body) < reach_m;
  return (close && kLongestVehicle.holds(grown, slack_m)) || (matched && kOrdinaryVehicle.holds(grown, slack_m));
}

/// True when a candidate is close to the points of what may be a person or a two-wheeler; others walk and ride beside
/// it.
bool isWithinReachOfSmall(const Eigen::AlignedBox3d& core, const BodyPoint& candidate, bool walks) {
  constexpr double kReach_m = 0.4, kReachUp_m = 0.6, kMostNoise_m = 0.5, kLongestTwoWheeler_m = 2;
  const double longest_m = walks ? kPerson.length_m : kLongestTwoWheeler_m;
  const double slack_m = std::min(kMostNoise_m, kDepthNoiseSigmas * std::sqrt(candidate.covariance.trace()));
  const Eigen::Vector3d reach_m(kReach_m, kReach_m, kReachUp_m);
  const Eigen::AlignedBox3d near(core.min() - reach_m, core.max() + reach_m);
  const Eigen::Vector3d grown_m = Eigen::AlignedBox3d(core).extend(candidate.p_body).sizes();
  return near.exteriorDistance(candidate.p_body) < slack_m &&
         hypotenuse(grown_m.x(), grown_m.y()) < longest_m + slack_m;
}

/// A region made as high as another one: of a body beside it only a point is known.
PointRegion asHigh(PointRegion beside, const PointRegion& other) {
  beside.box.top_px = std::min(beside.box.top_px, other.box.top_px);
  beside.box.bottom_px = std::max(beside.box.bottom_px, other.box.bottom_px);
  return beside;
}

bool mayMove(const ScenePoint& point) {
  return point.flow && point.flow->static_chi2 - point.flow->moving_chi2 > kNotStaticChi2;
}

}  // namespace

/// Adopts points that move with the body's velocity there. Quick checks come first.
void PointAdoption::operator()(TrackedObject& object, const SceneMotion& scene, const MotionComponent* component,
                               const SE3& T_world_cam, std::vector<bool>& taken) const {
  if (object.kinematics.speed_mps() < kMinSpeed_mps) return;
  constexpr int kKnownFrames = 2;  // from which on an object's points tell how large it is
  const bool small = object.life.observations() >= kKnownFrames && mayBeSmall(object);
  const bool walks = object.kinematics.speed_mps() < kFastestWalk_mps;
  const Eigen::AlignedBox3d known = small ? object.core(SE3{}) : object.extent(0);
  const std::optional<PointRegion> own = SeeThrough(scene, camera_).regionOf(object);
  std::vector<BodyPoint> adopted;
  const auto consider = [&](int i) {
    const ScenePoint& p = scene.points[i];
    if (taken[i] || p.ambiguous || p.label == PointLabel::kGround || !mayMove(p)) return;
    const BodyPoint candidate = toBody(p, object.T_cam_body, camera_);
    const bool within =
        small ? isWithinReachOfSmall(known, candidate, walks) : isWithinReach(known, candidate, component != nullptr);
    if (!within || !object.carries(*p.flow, T_world_cam)) return;
    if (own && isSeenThrough(scene, *own, asHigh(*regionOf(std::array{&p}), *own), camera_)) return;
    taken[i] = true;
    adopted.push_back(candidate);
  };
  if (component) {
    for (const int i : component->points) consider(i);
  } else {
    for (int i = 0; i < static_cast<int>(scene.points.size()); ++i) consider(i);
  }
  object.adopt(adopted);
}

void disownOtherBodies(TrackedObject& object, const SceneMotion& scene) {
  std::vector<int> members;
  for (const BodyPoint& p : object.points)
    if (const ScenePoint* seen = findPoint(scene, p.point); seen && seen->flow && !seen->ambiguous)
      members.push_back(static_cast<int>(seen - scene.points.data()));
  const std::vector<std::vector<int>> parts = rigidParts(members, scene.points);
  if (parts.size() < 2) return;
  const auto most = std::ranges::max_element(parts, {}, &std::vector<int>::size);
  const auto isOfOther = [&](const BodyPoint& p) {
    return std::ranges::any_of(parts, [&](const std::vector<int>& part) {
      return &part != &*most && std::ranges::any_of(part, [&](int i) { return scene.points[i].point == p.point; });
    });
  };
  std::erase_if(object.points, isOfOther);
}

}  // namespace motorcade
