#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/se3.hpp"
#include "core/timestamp.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Poses at times of their own, which increase.
struct StampedPoses {
  std::vector<Timestamp> stamps;
  std::vector<SE3> poses;
};

/// EuRoC's table: `time [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z`, and more columns, which are not read. Throws InputError.
StampedPoses readStampedPoses(const std::filesystem::path& file);

/// A trajectory in TUM form, `time tx ty tz qx qy qz qw`, with times in seconds; those too large for seconds are
/// nanoseconds, as ORB-SLAM3 writes them. Throws InputError.
StampedPoses readTumPoses(const std::filesystem::path& file);

/// KITTI-360's poses: the number of an image, then the rows of a pose. Takes those of images that the sequence has, at
/// these images' times. Throws InputError.
StampedPoses readNumberedPoses(const std::filesystem::path& file, const Sequence& sequence);

/// Poses of a file in any of these forms, at times of the images' clock. Empty where its lines are poses of the frames,
/// one for each. Times of another clock are converted where there is a pose for each image, and either the images' own
/// times are not known, or they have the same intervals. Throws InputError where the clocks cannot be related.
std::optional<StampedPoses> readTimedPoses(const std::filesystem::path& file, const Sequence& sequence);

}  // namespace motorcade
