#include "apps/evaluate/comparison/object_positions.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace motorcade {
namespace {

constexpr double kNear_m = 30;      // within which an origin has to stay where it is
constexpr std::size_t kSmooth = 5;  // frames of the running median: single frames may be off without a drift

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

Eigen::Vector3d medianOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d median;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& p : points) values.push_back(p[axis]);
    median[axis] = medianOf(std::move(values));
  }
  return median;
}

/// A followed label from one point of view: bodies and labels in the world, or seen from the camera.
struct Paths {
  std::vector<SE3> bodies, labels;

  std::vector<Eigen::Vector3d> originsOnLabel() const {
    std::vector<Eigen::Vector3d> origins;
    for (std::size_t i = 0; i < bodies.size(); ++i) origins.push_back(labels[i].inverse() * bodies[i].translation());
    return origins;
  }
  Statistics distances_m(const SE3& T_label_origin) const {
    std::vector<double> distances;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      distances.push_back((bodies[i].translation() - labels[i] * T_label_origin.translation()).norm());
    return statisticsOf(std::move(distances));
  }
  Statistics alignedDistances_m(const SE3& T_label_origin) const {
    Paths aligned = *this;
    for (auto& T_world_label : aligned.labels) T_world_label = T_world_label * T_label_origin;
    const SE3 alignment = alignPositions(bodies, aligned.labels);
    for (auto& T_world_body : aligned.bodies) T_world_body = alignment * T_world_body;
    return aligned.distances_m({});
  }
  Statistics turns_deg() const {
    const SE3 T_body_label = bodyOffset(bodies, labels);
    std::vector<double> turns;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      turns.push_back(angleOf_deg(labels[i].rotation().transpose() * (bodies[i] * T_body_label).rotation()));
    return statisticsOf(std::move(turns));
  }
};

std::optional<Eigen::Vector3d> originDrift_m(const FollowedLabel& label) {
  std::vector<Eigen::Vector3d> origins;
  for (const auto& frame : label.frames)
    if (frame.range_m() <= kNear_m) origins.push_back(frame.T_cam_label.inverse() * frame.T_cam_body.translation());
  if (origins.size() < kSmooth) return std::nullopt;
  Eigen::Vector3d least = Eigen::Vector3d::Constant(1e9), most = -least;
  for (auto first = origins.begin(); origins.end() - first >= std::ptrdiff_t{kSmooth}; ++first) {
    const Eigen::Vector3d origin = medianOf(std::vector(first, first + kSmooth));
    least = least.cwiseMin(origin);
    most = most.cwiseMax(origin);
  }
  return most - least;
}

/// The frames of `label` that are also in `other`.
FollowedLabel commonFrames(const FollowedLabel& label, const FollowedLabel& other) {
  std::set<FrameId> theirs;
  for (const auto& frame : other.frames) theirs.insert(frame.frame);
  FollowedLabel common = label;
  std::erase_if(common.frames, [&](const FollowedLabel::Frame& frame) { return !theirs.contains(frame.frame); });
  return common;
}

}  // namespace

std::optional<PositionErrors> positionErrors(const FollowedLabel& label) {
  if (label.frames.size() < 2) return std::nullopt;
  Paths world, seen;
  for (const auto& frame : label.frames) {
    world.bodies.push_back(frame.T_world_body);
    world.labels.push_back(frame.T_world_label);
    seen.bodies.push_back(frame.T_cam_body);
    seen.labels.push_back(frame.T_cam_label);
  }
  const auto offsetOf = [](const Paths& paths) {
    return SE3(Eigen::Matrix3d::Identity(), medianOf(paths.originsOnLabel()));
  };
  PositionErrors errors{.frames = label.frames.size(),
                        .ate_m = {},
                        .are_deg = world.turns_deg(),
                        .are_as_seen_deg = seen.turns_deg(),
                        .origin_drift_m = originDrift_m(label)};
  const auto at = [&](PositionKind kind) -> Statistics& { return errors.ate_m[static_cast<std::size_t>(kind)]; };
  at(PositionKind::kAligned) = world.alignedDistances_m({});
  at(PositionKind::kAlignedOffsetRemoved) = world.alignedDistances_m(offsetOf(world));
  at(PositionKind::kWorld) = world.distances_m({});
  at(PositionKind::kWorldOffsetRemoved) = world.distances_m(offsetOf(world));
  at(PositionKind::kAsSeen) = seen.distances_m({});
  at(PositionKind::kAsSeenOffsetRemoved) = seen.distances_m(offsetOf(seen));
  return errors;
}

MeanPositionErrors meanOf(const std::vector<PositionErrors>& objects) {
  MeanPositionErrors mean;
  for (const auto& object : objects) {
    if (object.frames < kLeastFramesOfMean) continue;
    ++mean.objects;
    for (std::size_t kind = 0; kind < kPositionKinds; ++kind) mean.ate_m[kind] += object.ate_m[kind].rmse;
    mean.are_deg += object.are_deg.rmse;
    mean.are_as_seen_deg += object.are_as_seen_deg.rmse;
    if (object.origin_drift_m) mean.largest_drift_m = mean.largest_drift_m.cwiseMax(*object.origin_drift_m);
  }
  const double n = std::max(1, mean.objects);
  for (double& ate_m : mean.ate_m) ate_m /= n;
  mean.are_deg /= n;
  mean.are_as_seen_deg /= n;
  return mean;
}

SE3 bodyOffset(const std::vector<SE3>& bodies, const std::vector<SE3>& labels) {
  if (bodies.empty()) return {};
  // The tangent-space mean, starting at the middle pair; three rounds suffice for spreads of some degrees.
  constexpr int kRounds = 3;
  SE3 mean = bodies[bodies.size() / 2].inverse() * labels[bodies.size() / 2];
  for (int round = 0; round < kRounds; ++round) {
    Vector6d step = Vector6d::Zero();
    for (std::size_t i = 0; i < bodies.size(); ++i) step += (mean.inverse() * bodies[i].inverse() * labels[i]).log();
    mean = mean * SE3::exp(step / static_cast<double>(bodies.size()));
  }
  return mean;
}

double ComparedObject::relativeError(std::size_t kind) const {
  const double theirs_m = baseline.ate_m[kind].rmse;
  return theirs_m > 0 ? (theirs_m - ours.ate_m[kind].rmse) / theirs_m : 0;
}

RunComparison compareRuns(const std::vector<FollowedLabel>& ours, const std::vector<FollowedLabel>& baseline) {
  std::map<std::int64_t, ComparedObject> best;
  for (const auto& a : ours) {
    for (const auto& b : baseline) {
      if (a.label != b.label) continue;
      const auto mine = positionErrors(commonFrames(a, b)), theirs = positionErrors(commonFrames(b, a));
      ComparedObject& object = best[a.label];
      if (mine && theirs && mine->frames > object.ours.frames) object = {a.label, a.track, b.track, *mine, *theirs};
    }
  }
  RunComparison comparison;
  for (const auto& [label, object] : best) {
    if (object.ours.frames == 0) continue;
    comparison.objects.push_back(object);
    if (object.ours.frames < kLeastFramesOfMean) continue;
    ++comparison.objects_of_mean;
    for (std::size_t kind = 0; kind < kPositionKinds; ++kind)
      comparison.mean_relative_error[kind] += object.relativeError(kind);
  }
  for (double& mean : comparison.mean_relative_error) mean /= std::max(1, comparison.objects_of_mean);
  return comparison;
}

}  // namespace motorcade
