#pragma once

#include <array>
#include <optional>
#include <vector>

#include "apps/evaluate/comparison/followed_objects.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"

/// Distance of a body's origin from its label's position, by several references.
namespace motorcade {

/// The reference of a position error. A body's origin is fixed to its object, but at an arbitrary place. `offset
/// removed` takes out the constant offset between origin and label, the median over the frames in the label's frame.
enum class PositionKind : std::size_t {
  kAligned,               // in the world, after SE(3) alignment of the whole path
  kAlignedOffsetRemoved,  // both
  kWorld,                 // in the world of the run's first camera, nothing aligned
  kWorldOffsetRemoved,
  kAsSeen,  // seen from the camera of the same frame: free of the camera's drift, and of its truth's errors
  kAsSeenOffsetRemoved
};
inline constexpr std::size_t kPositionKinds = 6;
/// Keys in the JSON.
inline constexpr std::array<const char*, kPositionKinds> kPositionKindNames{
    "aligned", "aligned_offset_removed", "world", "world_offset_removed", "as_seen", "as_seen_offset_removed"};

struct PositionErrors {
  std::size_t frames = 0;
  std::array<Statistics, kPositionKinds> ate_m;
  Statistics are_deg, are_as_seen_deg;  // rotation, without the mean rotation between body and label
  /// Drift of the origin on its object along the label's axes (length, height, width) while it is near. It is the
  /// largest minus the smallest value, after a median over a few frames. Empty when it is near for fewer frames.
  std::optional<Eigen::Vector3d> origin_drift_m;

  const Statistics& of(PositionKind kind) const { return ate_m[static_cast<std::size_t>(kind)]; }
};
/// Empty for fewer than two frames.
std::optional<PositionErrors> positionErrors(const FollowedLabel& label);

/// Least number of frames for the mean. Shorter paths say little: of two frames the median alone takes half of the
/// error.
inline constexpr std::size_t kLeastFramesOfMean = 10;

/// Mean over the objects that were followed for at least `kLeastFramesOfMean` frames.
struct MeanPositionErrors {
  int objects = 0;
  std::array<double, kPositionKinds> ate_m{};  // of the objects' root mean squares
  double are_deg = 0, are_as_seen_deg = 0;
  Eigen::Vector3d largest_drift_m = Eigen::Vector3d::Zero();
};
MeanPositionErrors meanOf(const std::vector<PositionErrors>& objects);

/// The constant X that brings estimated body frames to the labels' box frames, label = body * X, averaged over pairs.
SE3 bodyOffset(const std::vector<SE3>& bodies, const std::vector<SE3>& labels);

/// One label over the frames in which both runs followed it, by the two tracks with the most common frames.
struct ComparedObject {
  std::int64_t label = -1;
  TrackId track, baseline_track;
  PositionErrors ours, baseline;
  /// (ATE_baseline - ATE_ours) / ATE_baseline, of root mean squares.
  double relativeError(std::size_t kind) const;
};

struct RunComparison {
  std::vector<ComparedObject> objects;
  int objects_of_mean = 0;  // followed in at least `kLeastFramesOfMean` common frames
  std::array<double, kPositionKinds> mean_relative_error{};
};
/// Compares two runs of the same drive. Labels that only one of them followed are left out.
RunComparison compareRuns(const std::vector<FollowedLabel>& ours, const std::vector<FollowedLabel>& baseline);

}  // namespace motorcade
