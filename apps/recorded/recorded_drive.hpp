#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/stereo_camera.hpp"
#include "io/results/object_points.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/ground_truth.hpp"

namespace motorcade {

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
