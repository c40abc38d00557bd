#pragma once

#include <cstdint>
#include <filesystem>
#include <map>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/ground_truth.hpp"

/// The tables of a variation of Virtual KITTI 2: intrinsic.txt, extrinsic.txt, pose.txt, bbox.txt and info.txt. Each
/// has a header, then a line for each frame, camera and object. Functions throw InputError naming file and line.
namespace motorcade {

/// The pair of Camera_0 and Camera_1, without a size. The baseline is the data set's stated one if the extrinsics, with
/// their seven digits, agree with it.
StereoCamera readVirtualKittiCamera(const std::filesystem::path& tables);

/// Poses of Camera_0 by the numbers of the frames, in the world of the data set.
std::map<std::int64_t, SE3> readVirtualKittiPoses(const std::filesystem::path& tables);

/// Truth of a sequence whose tables are `sequence.truth.virtual_kitti`.
CameraTruth virtualKittiCamera(const Sequence& sequence);
/// Empty objects where pose.txt or bbox.txt is missing.
std::optional<ObjectTruths> virtualKittiObjects(const Sequence& sequence, const CameraTruth& camera);

}  // namespace motorcade
