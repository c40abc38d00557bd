#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/stereo_camera.hpp"
#include "core/timestamp.hpp"
#include "io/results/object_points.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/ground_truth.hpp"

/// A recorded drive, and which of its labeled objects move: they are separated from those that stand, though the labels
/// of both jitter.
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

/// The data for pictures and pages of a run, without the images. Poses are in the world of the run, its first frame.
struct RecordedDrive {
  std::string name{};  // of the run's folder
  StereoCamera camera;
  std::vector<Timestamp> stamps;  // of the run's frames
  std::int64_t first_frame = 0;
  std::vector<SE3> T_world_cam, T_world_cam_true;  // the truth may be empty
  /// Objects and points by index in the run.
  std::map<std::int64_t, std::vector<ObjectEstimate>> objects;
  std::map<std::int64_t, std::vector<ObjectPoint>> points;  // empty where the run did not write them
  std::map<std::int64_t, std::vector<ObjectTruth>> true_objects;
  std::set<std::int64_t> true_movers;  // labels that travel in some frame of the sequence; the others are parked

  std::vector<ObjectEstimate> objectsAt(std::size_t frame) const;
  std::vector<ObjectPoint> pointsAt(std::size_t frame) const;
  /// The frame's estimate of a track, or null.
  const ObjectEstimate* find(std::size_t frame, TrackId track) const;
  /// World positions of a point of an object's body, from `earliest` up to `frame`.
  std::vector<Eigen::Vector3d> wayOf(TrackId track, const Eigen::Vector3d& p_body, std::size_t earliest,
                                     std::size_t frame) const;
};

/// The final trajectories, or the online ones of a run that was killed, as it has few final poses.
const RunFolder::Trajectories& fullerTrajectories(const RunFolder& run);

/// Combines a run with the truth of its sequence. Throws InputError naming the file that cannot be read.
RecordedDrive recordedDrive(const RunFolder& run, const Sequence& sequence);
/// Uses the run alone: there is no truth and no camera.
RecordedDrive recordedDrive(const RunFolder& run);

}  // namespace motorcade
