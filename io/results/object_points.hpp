#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/messages.hpp"

/// `object_points.csv` (docs/formats.md): image positions of objects' points.
namespace motorcade {

inline constexpr const char* kObjectPointsFile = "object_points.csv";
inline constexpr std::string_view kObjectPointsHeader = "frame,track_id,point_id,u_px,v_px,disparity_px";

/// A point of an object in one frame: left pixel and disparity as measured.
struct ObjectPoint {
  FrameId frame;
  TrackId track;
  PointId point;
  Eigen::Vector3d uvd_px = Eigen::Vector3d::Zero();
};

std::string objectPointLine(const ObjectPoint& point);
/// Throws InputError naming file and line. A last line that was cut off by a kill is ignored.
std::vector<ObjectPoint> readObjectPoints(const std::filesystem::path& file);

}  // namespace motorcade
