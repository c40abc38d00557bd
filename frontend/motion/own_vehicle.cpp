#include "frontend/motion/own_vehicle.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace motorcade {
namespace {

/// Distance ahead that no visible part of the own vehicle exceeds; no road user in front of it is nearer.
constexpr double kReachAhead_m = 3.5;
/// Distance aside that only the own vehicle can take, half a car's width. It reaches on as far as points that stay
/// follow each other without a gap; a vehicle in the next lane is farther away.
constexpr double kReachAside_m = 1.0, kGap_m = 0.3;

constexpr double kCompany_m = 0.5;  // points of the own vehicle have others as near, ...
constexpr int kCompany = 3;         // ... so many, at least

constexpr double kMove_px = 10;  // of a point at rest: twenty times the tolerance of one that stays
/// Each coordinate may change by this beyond the noise: camera and hood shake against each other.
constexpr double kTolerance_px = 0.5;
constexpr double kMaxChi2 = 16.3;  // 3 degrees of freedom: 99.9 %
/// Way of the camera between two votes, so that their views differ: ten of them take a meter.
constexpr double kVoteTravel_m = 0.1;

double misfitChi2(const Eigen::Vector3d& difference_px, const Eigen::Vector3d& sigma_then_px,
                  const Eigen::Vector3d& sigma_now_px) {
  const Eigen::Array3d variance_px2 =
      sigma_then_px.array().square() + sigma_now_px.array().square() + kTolerance_px * kTolerance_px;
  return (difference_px.array().square() / variance_px2).sum();
}

/// T_now_then * p_then, without computing the inverse as a whole.
Eigen::Vector3d intoNow(const CameraTrail::Relation& relation, const Eigen::Vector3d& p_then) {
  return relation.T_then_now.rotation().transpose() * (p_then - relation.T_then_now.translation());
}

/// True when other points are around, among those ordered from left to right. A wrong disparity on a vehicle that keeps
/// our pace is alone, or nearly so.
template <class Points>
bool hasCompany(const Eigen::Vector3d& p_cam, const Points& points) {
  const auto x_m = [](const auto& point) { return point.p_cam.x(); };
  int near = -1;  // it is among them itself
  for (auto at = std::ranges::lower_bound(points, p_cam.x() - kCompany_m, {}, x_m); at != points.end(); ++at) {
    if (at->p_cam.x() > p_cam.x() + kCompany_m) return false;
    near += (at->p_cam - p_cam).norm() < kCompany_m;
    if (near >= kCompany) return true;
  }
  return false;
}

}  // namespace

OwnVehicle::OwnVehicle(const StereoCamera& camera)
    : camera_(camera), map_(camera), left_m_(-kReachAside_m), right_m_(kReachAside_m) {}

bool OwnVehicle::isNear(const StereoObservation& seen) const {
  return camera_.fx_px * camera_.baseline_m < kReachAhead_m * seen.uvd_px.z();
}

/// True when a new point may say something of the own vehicle.
bool OwnVehicle::isOfInterest(const StereoObservation& seen) const {
  const double u_px = seen.uvd_px.x(), v_px = seen.uvd_px.y();
  return isNear(seen) || map_.isNearVotes(u_px, v_px) || map_.isMasked(u_px, v_px);
}

bool OwnVehicle::stays(const Watched& point, const StereoObservation& seen) const {
  return misfitChi2(seen.uvd_px.cast<double>() - point.uvd_px, point.sigma_px, seen.sigma_px.cast<double>()) < kMaxChi2;
}

void OwnVehicle::leaveOut(const OpticalFlow& flow, std::vector<std::optional<StereoObservation>>& observed) const {
  if (!map_.empty())
    for (auto& seen : observed)
      if (seen && map_.isMasked(seen->uvd_px.x(), seen->uvd_px.y())) seen.reset();
  auto point = watched_.begin();
  for (std::size_t i = 0; i < observed.size() && point != watched_.end(); ++i) {
    while (point != watched_.end() && point->point < flow.observations[i].point) ++point;
    if (point == watched_.end() || point->point != flow.observations[i].point) continue;
    if (observed[i] && point->fixed && stays(*point, *observed[i])) observed[i].reset();
  }
}

/// Compares a point with where it was seen before. A point that neither stays nor rests is compared anew from here on.
OwnVehicle::Verdict OwnVehicle::judge(Watched& point, const StereoObservation& seen, const CameraTrail& trail) const {
  const bool staying = stays(point, seen);
  if (point.fixed && staying) return Verdict::kStays;
  const Eigen::Vector3d uvd_px = seen.uvd_px.cast<double>();
  if (const auto* relation = trail.find(point.step)) {
    const auto at_rest = camera_.project(intoNow(*relation, camera_.triangulate(point.uvd_px)));
    const bool moves = !at_rest || (*at_rest - point.uvd_px).norm() > kMove_px;
    if (moves && staying && isNear(seen)) return Verdict::kStays;
    if (moves && at_rest && misfitChi2(uvd_px - *at_rest, point.sigma_px, seen.sigma_px.cast<double>()) < kMaxChi2)
      return Verdict::kRests;
    if (staying || !moves) return Verdict::kNone;
  }
  point = {point.point, trail.newest().step, uvd_px, seen.sigma_px.cast<double>()};
  return Verdict::kNone;
}

/// Takes the staying points for fixed that are not alone and lie where the own vehicle reaches.
void OwnVehicle::takeFixed(std::vector<Staying> staying, std::vector<Watched>& watched) {
  std::ranges::sort(staying, {}, [](const Staying& point) { return point.p_cam.x(); });
  std::erase_if(staying, [&, all = staying](const Staying& point) {
    return !watched[point.watched].fixed && !hasCompany(point.p_cam, all);
  });
  widen(staying);
  for (const Staying& point : staying) {
    Watched& stayed = watched[point.watched];
    stayed.fixed |= point.p_cam.x() >= left_m_ && point.p_cam.x() <= right_m_;
    if (stayed.fixed) map_.voteFor(stayed.uvd_px.x(), stayed.uvd_px.y());
  }
}

/// Finds how far the own vehicle reaches to either side, going outwards over points that are ordered from left to
/// right.
void OwnVehicle::widen(const std::vector<Staying>& staying) {
  for (const Staying& point : staying)
    if (const double x_m = point.p_cam.x(); x_m > right_m_ && x_m < right_m_ + kGap_m) right_m_ = x_m;
  std::for_each(staying.rbegin(), staying.rend(), [&](const Staying& point) {
    if (const double x_m = point.p_cam.x(); x_m < left_m_ && x_m > left_m_ - kGap_m) left_m_ = x_m;
  });
}

/// True when the camera has gone on since the last vote.
bool OwnVehicle::isTimeToVote(const CameraTrail& trail) {
  const Eigen::Vector3d& here = trail.newest().T_world_cam.translation();
  if (voted_at_ && (here - *voted_at_).norm() < kVoteTravel_m) return false;
  voted_at_ = here;
  return true;
}

void OwnVehicle::learn(const OpticalFlow& flow, const std::vector<std::optional<StereoObservation>>& seen,
                       const CameraTrail& trail) {
  std::vector<Watched> watched;
  watched.reserve(watched_.size());
  std::vector<Staying> staying;
  auto before = watched_.begin();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const PointId id = flow.observations[i].point;
    while (before != watched_.end() && before->point < id) ++before;
    const bool known = before != watched_.end() && before->point == id;
    if (known) watched.push_back(*before);
    if (!seen[i] || (!known && !isOfInterest(*seen[i]))) continue;
    const Eigen::Vector3d uvd_px = seen[i]->uvd_px.cast<double>();
    if (!known) {
      watched.push_back({id, trail.newest().step, uvd_px, seen[i]->sigma_px.cast<double>()});
      continue;
    }
    const Verdict verdict = judge(watched.back(), *seen[i], trail);
    if (verdict == Verdict::kRests) map_.voteAgainst(uvd_px.x(), uvd_px.y());
    if (verdict == Verdict::kStays) staying.push_back({watched.size() - 1, camera_.triangulate(uvd_px)});
  }
  takeFixed(std::move(staying), watched);
  watched_ = std::move(watched);
  if (isTimeToVote(trail))
    map_.count();
  else
    map_.discard();
}

void OwnVehicle::shiftDisparities(double change_px) {
  for (Watched& point : watched_) point.uvd_px.z() += change_px;
}

}  // namespace motorcade
