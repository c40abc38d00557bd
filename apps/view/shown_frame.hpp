#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/frame_timing.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "io/outline_polygons.hpp"

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

/// How long a frame took.
struct ShownTiming {
  double latency_ms = 0, decode_ms = 0;
  std::array<double, kStageCount> stages_ms{};
};

/// All that the page shows of one frame, but for the image; of a run that goes on and of one that is over alike.
struct ShownFrame {
  FrameEstimate estimate;
  std::vector<ShownOutline> outlines{};
  std::vector<ShownPoint> points{};
  std::optional<RoadPlane> road{};
  std::optional<ShownTiming> timing{};
};

/// The road as the objects on it tell: they stand on it upright. Empty where none has a cuboid.
std::optional<RoadPlane> roadUnder(const FrameEstimate& estimate);

}  // namespace motorcade
