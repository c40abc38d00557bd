#pragma once

#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/draw/canvas.hpp"
#include "core/stereo_camera.hpp"
#include "io/ground_truth.hpp"
#include "io/image_file.hpp"
#include "io/object_points.hpp"
#include "io/run_folder.hpp"

namespace motorcade {

/// All that the pictures of a run need, but for the images. Poses are in the world of the run, its first frame.
struct DrawnRun {
  StereoCamera camera;
  std::vector<Timestamp> stamps;  // of the run's frames
  std::int64_t first_frame = 0;
  std::vector<SE3> T_world_cam, T_world_cam_true;  // the truth may be empty
  /// By index in the run.
  std::map<std::int64_t, std::vector<ObjectEstimate>> objects;
  std::map<std::int64_t, std::vector<ObjectPoint>> points;  // empty where the run did not write them
  std::map<std::int64_t, std::vector<ObjectTruth>> true_objects;

  std::vector<ObjectEstimate> objectsAt(std::size_t frame) const;
  std::vector<ObjectPoint> pointsAt(std::size_t frame) const;
  /// Where a point of an object's body was, from `earliest` up to `frame`, in the world.
  std::vector<Eigen::Vector3d> wayOf(TrackId track, const Eigen::Vector3d& p_body, std::size_t earliest,
                                     std::size_t frame) const;
};

/// What is drawn on: the left image and the mask of the objects, where there is one.
struct DrawnImages {
  Image left;
  std::optional<Gray16Image> mask{};
};

/// Each track its color, the same in every picture.
Color trackColor(TrackId track);

/// Halfway to white: for points on what has the color itself.
Color lightened(Color color);

/// As printf.
template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 128> text;
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

}  // namespace motorcade
