#pragma once

#include <string>

#include "apps/export/exported_frame.hpp"
#include "core/stereo_camera.hpp"

/// Messages of a single frame, each as serialized Protobuf.
namespace motorcade {

/// foxglove.CompressedImage
std::string imageMessage(const ExportedFrame& frame);
/// foxglove.CameraCalibration of the left camera.
std::string calibrationMessage(const StereoCamera& camera, Timestamp stamp);
/// foxglove.FrameTransforms: map to world, world to camera, world to each object.
std::string transformsMessage(const FrameEstimate& estimate);
/// foxglove.PoseInFrame: the camera in the world.
std::string poseMessage(const FrameEstimate& estimate);
/// foxglove.PosesInFrame: the camera's way through the world.
std::string pathMessage(Timestamp stamp, const std::vector<SE3>& T_world_cam);
/// foxglove.PointCloud in the camera's frame: x, y, z, the object's track (-1 at rest) and its color.
std::string pointsMessage(const ExportedFrame& frame);
/// motorcade.FrameDiagnostics
std::string diagnosticsMessage(const ExportedFrame& frame);

}  // namespace motorcade
