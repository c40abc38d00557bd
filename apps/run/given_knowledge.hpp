#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/stages.hpp"
#include "core/pixel_mask.hpp"
#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// The pixels of the left image that `run --ignore` names. An item is SIDE=PIXELS, a number of rows or columns at a
/// side. It may also be the file of an image of the camera's size, in which ignored pixels are not black. Throws
/// UsageError or InputError.
PixelMask ignoredPixels(const std::vector<std::string>& items, const StereoCamera& camera);

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
