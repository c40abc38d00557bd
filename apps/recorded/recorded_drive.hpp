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

/// All that pictures and pages of a run show, but for the images. Poses are in the world of the run, its first frame.
struct RecordedDrive {
  std::string name{};  // of the run's folder
  StereoCamera camera;
  std::vector<Timestamp> stamps;  // of the run's frames
  std::int64_t first_frame = 0;
  std::vector<SE3> T_world_cam, T_world_cam_true;  // the truth may be empty
  /// By index in the run.
  std::map<std::int64_t, std::vector<ObjectEstimate>> objects;
  std::map<std::int64_t, std::vector<ObjectPoint>> points;  // empty where the run did not write them
  std::map<std::int64_t, std::vector<ObjectTruth>> true_objects;
  std::set<std::int64_t> true_movers;  // labels that travel in some frame of the sequence; the others are parked

  std::vector<ObjectEstimate> objectsAt(std::size_t frame) const;
  std::vector<ObjectPoint> pointsAt(std::size_t frame) const;
  /// What the frame knows of a track, or null.
  const ObjectEstimate* find(std::size_t frame, TrackId track) const;
  /// Where a point of an object's body was, from `earliest` up to `frame`, in the world.
  std::vector<Eigen::Vector3d> wayOf(TrackId track, const Eigen::Vector3d& p_body, std::size_t earliest,
                                     std::size_t frame) const;
};

/// Of a run that was killed what was published online, as it has few final poses.
const RunFolder::Trajectories& fullerTrajectories(const RunFolder& run);

/// What a run and the truth of its sequence tell. Throws InputError naming the file that cannot be read.
RecordedDrive recordedDrive(const RunFolder& run, const Sequence& sequence);
/// What the run alone tells: nothing of the truth, nor of the camera.
RecordedDrive recordedDrive(const RunFolder& run);

}  // namespace motorcade
