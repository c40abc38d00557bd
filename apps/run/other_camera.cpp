#include "apps/run/other_camera.hpp"

#include <memory>
#include <utility>

#include "apps/pipeline/pipeline_config.hpp"
#include "apps/run/run_options.hpp"
#include "io/files/errors.hpp"
#include "io/truth/trajectory.hpp"

namespace motorcade {

std::optional<std::vector<SE3>> otherCamera(const RunOptions& options, const PipelineConfig& config,
                                            const Sequence& sequence) {
  if (options.camera_poses.empty()) return std::nullopt;
  if (config.backend.kind == BackendKind::kJoint)
    throw UsageError(
        "--camera-poses: the joint back-end estimates the camera from points and takes no other path; use backend.kind "
        "\"filter\", \"filter_map\" or \"pose_graph\"");
  std::vector<SE3> poses = readKittiPoses(options.camera_poses);
  if (poses.size() != sequence.frames.size())
    throw InputError(options.camera_poses.string() + ": " + std::to_string(poses.size()) +
                     " poses, but the sequence has " + std::to_string(sequence.frames.size()) +
                     " frames; write one line for each of them");
  return poses;
}

void replaceOdometry(Stages& stages, std::vector<SE3> T_world_cam) {
  const auto previous = std::make_shared<std::optional<FrameId>>();
  stages.incremental_optimization = [optimize = std::move(stages.incremental_optimization),
                                     T_world_cam = std::move(T_world_cam),
                                     previous](const FrameMeasurementsPtr& measurements) {
    FrameMeasurements replaced = *measurements;
    const auto poseOf = [&](FrameId frame) { return T_world_cam.at(static_cast<std::size_t>(frame.value)); };
    if (*previous) replaced.odometry.T_previous_now = poseOf(**previous).inverse() * poseOf(replaced.head.frame);
    *previous = replaced.head.frame;
    return optimize(std::make_shared<const FrameMeasurements>(std::move(replaced)));
  };
}

}  // namespace motorcade
