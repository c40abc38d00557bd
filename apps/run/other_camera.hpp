#pragma once

#include <optional>
#include <vector>

#include "apps/pipeline/stages.hpp"
#include "core/se3.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

struct PipelineConfig;
struct RunOptions;

/// The camera's path of `--camera-poses`, one pose for each frame of the sequence; empty without that option. Throws
/// UsageError for the joint back-end, which estimates its own odometry from the points at rest. Throws InputError for a
/// file that does not fit the sequence.
std::optional<std::vector<SE3>> otherCamera(const RunOptions& options, const PipelineConfig& config,
                                            const Sequence& sequence);

/// Makes the back-end use the motions of that path in place of the front-end's odometry, whose covariances stay.
void replaceOdometry(Stages& stages, std::vector<SE3> T_world_cam);

}  // namespace motorcade
