#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_timing.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "io/results/outline_polygons.hpp"

namespace motorcade {

/// The road around the camera.
struct RoadPlane {
  Eigen::Vector3d point_world = Eigen::Vector3d::Zero();  // below the camera
  Eigen::Vector3d up_world = -Eigen::Vector3d::UnitY();
};

struct ShownPoint {
  TrackId track;
  Eigen::Vector2d uv_px = Eigen::Vector2d::Zero();
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
};

struct ShownOutline {
  TrackId track;
  std::vector<Polygon> polygons;
};

/// Times of a frame.
struct ShownTiming {
  double latency_ms = 0, decode_ms = 0;
  std::array<double, kStageCount> stages_ms{};
};

/// A labeled object, placed by the estimated camera at its true pose relative to the true camera. Its distance from the
/// estimate is the error as seen from the camera, without the drift of the path.
struct ShownTrueObject {
  std::int64_t label = -1;
  std::string type{};
  SE3 T_world_object;                                // KITTI's box frame
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // height, width, length
  bool moving = false;                               // in this frame, and well enough in view to be asked for
  TrackId track{};                                   // that was matched to it; not valid for none
  double off_m = 0;                                  // from the track's middle, on the ground
  std::optional<double> motion_m{};                  // error of the track's motion since the frame before
};

/// Comparison of one frame with the truth.
struct ShownTruth {
  SE3 T_world_cam;
  double position_m = 0;            // of the camera, the path moved onto the truth as a whole
  double step_m = 0, step_deg = 0;  // of the camera's motion since the frame before
  std::vector<ShownTrueObject> objects{};
};

/// All data of one frame on the page, but for the image, of a running or finished run.
struct ShownFrame {
  FrameEstimate estimate;
  std::vector<ShownOutline> outlines{};
  std::vector<ShownPoint> points{};
  std::optional<RoadPlane> road{};
  std::optional<ShownTiming> timing{};
  std::optional<ShownTruth> truth{};
};

/// The road under the objects, which stand on it upright. Empty where none has a cuboid.
std::optional<RoadPlane> roadUnder(const FrameEstimate& estimate);

}  // namespace motorcade
