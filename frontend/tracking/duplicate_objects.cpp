#include "frontend/tracking/duplicate_objects.hpp"

#include <algorithm>
#include <cmath>

#include "core/elementary.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/search_by_projection.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

constexpr double kMaxSpeedDifference_mps = 1.5;  // of two objects on one vehicle, where their frames' origins are
// Excess of two objects over one vehicle or one person at most, however uncertain their positions are.
constexpr double kMaxSlack_m = 2, kMaxSlackOfPerson_m = 0.5;
constexpr double kSigmas = 2;  // that slack, and what uncertain speeds add, in standard deviations

/// True when most points of the one lie within the other, as vehicles do not overlap.
bool isWithin(const TrackedObject& one, const SE3& T_other_one, const TrackedObject& other) {
  constexpr double kMargin_m = 0.3, kMost = 0.7;  // a margin, as a face alone has no depth
  Eigen::AlignedBox3d box = other.core(SE3{});
  box.min().array() -= kMargin_m;
  box.max().array() += kMargin_m;
  const auto inside =
      std::ranges::count_if(one.points, [&](const BodyPoint& p) { return box.contains(T_other_one * p.p_body); });
  return static_cast<double>(inside) > kMost * static_cast<double>(one.points.size());
}

/// True when the younger lies on the flank of the older one. Points behind the front of a lorry or a bus, as the camera
/// sees it, lie on its flank if they move alike and in its track. A car that follows is hidden, or a gap shows between
/// the two. A nearer object may be a car before the lorry.
bool isFlank(const TrackedObject& older, const Eigen::AlignedBox3d& own, const TrackedObject& younger,
             const Eigen::AlignedBox3d& other, const Eigen::Array3d& slack_m) {
  constexpr double kHigherThanAVan_m = 2.3;
  if (own.sizes().z() < kHigherThanAVan_m || !kLongestVehicle.holds(own.merged(other), slack_m)) return false;
  return (younger.T_cam_body * younger.middle()).norm() > (older.T_cam_body * own.center()).norm();
}

/// Two standard deviations of the place of one relative to the other, along the axes of the older. Of what is far ahead
/// the distance is uncertain and the lane is not: cars abreast stay two.
Eigen::Array3d slackBetween_m(const TrackedObject& older, const TrackedObject& younger, const SE3& T_older_younger) {
  const Eigen::Matrix3d& R = T_older_younger.rotation();
  const Eigen::Matrix3d covariance = older.kinematics.poseCovariance().topLeftCorner<3, 3>() +
                                     R * younger.kinematics.poseCovariance().topLeftCorner<3, 3>() * R.transpose();
  return (kSigmas * covariance.diagonal().array().sqrt()).min(kMaxSlack_m);
}

/// Box around an object's points, moved by `T`. Where none is left, it is where their middle was.
Eigen::AlignedBox3d placeOf(const TrackedObject& object, const SE3& T) {
  Eigen::AlignedBox3d box = object.core(T);
  if (box.isEmpty()) box.extend(T * object.last_middle_body);
  return box;
}

/// True for what may be two people of whom one walks. The other may stand, or its speed may be wrong for some frames.
bool arePeople(const TrackedObject& one, const TrackedObject& other, const StereoCamera& camera) {
  const bool walks = mayBeWalking(one, camera) || mayBeWalking(other, camera);
  return walks && mayBeOnFoot(one) && mayBeOnFoot(other);
}

bool areDuplicates(const TrackedObject& older, const TrackedObject& younger, const SeeThrough& see_through,
                   const StereoCamera& camera) {
  // A younger one that was observed for longer than the older one is lost is another vehicle.
  if (older.life.missed() > 0 && younger.life.observations() > 1) return false;
  const SE3 T_older_younger = older.T_cam_body.inverse() * younger.T_cam_body;
  const double difference_mps =
      (older.velocityAt_mps(T_older_younger.translation()) - younger.kinematics.velocityWorld_mps()).norm();
  const double sigma_mps = hypotenuse(older.kinematics.speedSigma_mps(), younger.kinematics.speedSigma_mps());
  if (difference_mps >= kMaxSpeedDifference_mps + kSigmas * sigma_mps) return false;
  const Eigen::AlignedBox3d own = placeOf(older, SE3{}), other = placeOf(younger, T_older_younger);
  const Eigen::Array3d slack_m = slackBetween_m(older, younger, T_older_younger);
  if (arePeople(older, younger, camera)) return kPerson.holds(own.merged(other), slack_m.min(kMaxSlackOfPerson_m));
  // Not where the younger is tall: a car before a lorry would end in it.
  const VehicleSize& size = isTall(own) ? kTallVehicle : kOrdinaryVehicle;
  if (size.holds(own.merged(other), slack_m)) return true;
  if (difference_mps >= kMaxSpeedDifference_mps) return false;
  if (isFlank(older, own, younger, other, slack_m)) return !see_through.isGapBetween(older, younger);
  return isWithin(younger, T_older_younger, older) || isWithin(older, T_older_younger.inverse(), younger);
}

bool isInView(const TrackedObject& object, const StereoCamera& camera) {
  const auto uvd_px = camera.project(object.T_cam_body.translation());
  return uvd_px && camera.inLeftImage(uvd_px->x(), uvd_px->y());
}

/// True when the younger stays: a guess gives way, and an object that has left the view gives way to one in it. The
/// last points of a trailer that we pass are on its truck.
bool youngerStays(const TrackedObject& older, const TrackedObject& younger, const StereoCamera& camera) {
  if (older.isGuess() != younger.isGuess()) return older.isGuess();
  if (!younger.life.reported()) return false;
  return !older.life.reported() || (!isInView(older, camera) && isInView(younger, camera));
}

void merge(TrackedObject& stays, TrackedObject& ends) {
  const SE3 T_stays_ends = stays.T_cam_body.inverse() * ends.T_cam_body;
  std::erase_if(ends.points, [](const BodyPoint& p) { return !isFollowed(p.point); });  // patches are numbered anew
  for (BodyPoint& p : ends.points) {
    p.moveTo(T_stays_ends);
    p.misfits = 0;
  }
  stays.adopt(ends.points);
  ends.life.end();
}

}  // namespace

void mergeDuplicates(std::vector<TrackedObject>& objects, const SeeThrough& see_through, const StereoCamera& camera) {
  const auto ended = [](const TrackedObject& object) { return object.life.phase() == Phase::kEnded; };
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = i + 1; j < objects.size(); ++j) {
      TrackedObject &older = objects[i], &younger = objects[j];
      if (ended(older) || ended(younger) || !areDuplicates(older, younger, see_through, camera)) continue;
      if (see_through.areApart(older, younger)) continue;
      if (youngerStays(older, younger, camera))
        merge(younger, older);
      else
        merge(older, younger);
    }
  }
}

}  // namespace motorcade
