#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/se3.hpp"
#include "core/timestamp.hpp"

namespace motorcade {

/// `r00 r01 r02 tx r10 ... tz`: T_world_cam in nine decimals, without the line end.
std::string kittiLine(const SE3& T_world_cam);
/// `seconds tx ty tz qx qy qz qw`; the seconds are printed from the integer.
std::string tumLine(Timestamp stamp, const SE3& T_world_cam);

/// One KITTI pose per line, as its upper three rows or all four; `#` begins a comment. Throws InputError naming the
/// line.
std::vector<SE3> readKittiPoses(const std::filesystem::path& file);
void writeKittiPoses(const std::filesystem::path& file, const std::vector<SE3>& poses);

}  // namespace motorcade
