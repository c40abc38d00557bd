#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/draw/canvas.hpp"
#include "core/stereo_camera.hpp"
#include "io/ground_truth.hpp"
#include "io/run_folder.hpp"

namespace motorcade {

/// All that the pictures of a run need. Poses are in the world of the run, its first frame.
struct DrawnRun {
  StereoCamera camera;
  std::vector<Timestamp> stamps;  // of the run's frames
  std::int64_t first_frame = 0;
  std::vector<SE3> T_world_cam, T_world_cam_true;               // the truth may be empty
  std::map<std::int64_t, std::vector<ObjectEstimate>> objects;  // by index in the run
  std::map<std::int64_t, std::vector<ObjectTruth>> true_objects;
};

/// Each track its color, the same in every picture.
Color trackColor(TrackId track);

/// The left image with each object's box, name, speed and distance, its path so far and an arrow of one second's
/// motion.
Canvas drawImageView(const Image& left, const DrawnRun& run, std::size_t frame);

/// The scene from above, the camera heading right: the paths so far of camera and objects, with the truth dashed.
Canvas drawTopView(const DrawnRun& run, std::size_t frame, int width, int height);

/// The one above the other.
Canvas drawFrame(const Image& left, const DrawnRun& run, std::size_t frame);

}  // namespace motorcade
