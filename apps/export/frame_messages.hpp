#pragma once

#include <deque>
#include <map>
#include <string>

#include "apps/export/exported_frame.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

/// Messages of a single frame, each as serialized Protobuf.
namespace motorcade {

/// Makes a foxglove.SceneUpdate of each frame's objects: an entity `object_N` in the world with its cuboid, the path of
/// its center over the last three seconds, and a label. Objects that have left are deleted. Call it in frame order.
class SceneMessages {
 public:
  std::string operator()(const FrameEstimate& estimate);

 private:
  struct Passed {
    Timestamp stamp;
    Eigen::Vector3d p_world;
  };
  void remember(const FrameEstimate& estimate);

  std::map<TrackId, std::deque<Passed>> ways_;  // of the objects in the frame before
};

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
