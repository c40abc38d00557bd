#pragma once

#include <filesystem>
#include <vector>

#include "core/se3.hpp"
#include "core/timestamp.hpp"
#include "io/sequence.hpp"

namespace motorcade {

/// Poses at times of their own, which increase.
struct StampedPoses {
  std::vector<Timestamp> stamps;
  std::vector<SE3> poses;
};

/// EuRoC's table: `time [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z`, and more columns, which are not read. Throws InputError.
StampedPoses readStampedPoses(const std::filesystem::path& file);

/// KITTI-360's: the number of an image, then the rows of a pose; those of images that the sequence has, at the times
/// it gives them. Throws InputError.
StampedPoses readNumberedPoses(const std::filesystem::path& file, const Sequence& sequence);

/// The pose at a time between, or a little outside, the given ones, of which there are two at least: position and
/// attitude each at a constant rate.
SE3 poseAt(Timestamp stamp, const std::vector<SE3>& poses, const std::vector<Timestamp>& stamps);

}  // namespace motorcade
