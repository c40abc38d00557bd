#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "core/timestamp.hpp"
#include "io/truth/ground_truth.hpp"

/// Separates labeled objects that move from those that stand, though the labels of both jitter.
namespace motorcade {

/// Speed above which an object moves in a frame, over the frames around it.
inline constexpr double kMovingSpeed_mps = 1;

/// A place of an object at a time.
struct StampedPlace {
  Timestamp stamp;
  Eigen::Vector3d p_world;
};

/// True for a track, in the order of its times, that leaves its first place and travels there. It is somewhere farther
/// than 1.5 m from that place, and somewhere covers 1.5 m at over `kMovingSpeed_mps`, by more than a single jump. So a
/// closed lap travels, and an object that waits first; a parked car whose labels wander does not.
bool travels(const std::vector<StampedPlace>& track);

/// The ids of the labels that travel; `stamps` are the times of the sequence's frames.
std::set<std::int64_t> travelingLabels(const std::vector<ObjectTruth>& objects, const std::vector<Timestamp>& stamps);

}  // namespace motorcade
