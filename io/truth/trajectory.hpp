#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/se3.hpp"
#include "core/timestamp.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {

/// `r00 r01 r02 tx r10 ... tz`: T_world_cam in nine decimals, without the line end.
std::string kittiLine(const SE3& T_world_cam);
/// `seconds tx ty tz qx qy qz qw`; the seconds are printed from the integer.
std::string tumLine(Timestamp stamp, const SE3& T_world_cam);

/// One KITTI pose per line, as its upper three rows or all four; `#` begins a comment. Throws InputError naming the
/// line.
std::vector<SE3> readKittiPoses(const std::filesystem::path& file);
void writeKittiPoses(const std::filesystem::path& file, const std::vector<SE3>& poses);

/// The form in which a file of poses is written.
enum class PoseForm {
  kRows,      // 12 numbers, the upper three rows of T_world_cam, or 16, all four
  kTum,       // time tx ty tz qx qy qz qw
  kEuroc,     // time [ns],tx,ty,tz,qw,qx,qy,qz, and maybe more
  kNumbered,  // the number of an image, then 16 numbers, as in KITTI-360
};

/// Lines that hold data: without comments, which `#` begins, and without a table's header of words.
std::vector<TextLine> readPoseLines(const std::filesystem::path& file);

/// The form by the first line. Throws InputError saying what the file seems to be and which forms are read.
PoseForm poseFormOf(const std::filesystem::path& file, const std::vector<TextLine>& lines);

/// The character between the fields of a line.
char separatorOf(const TextLine& line);

}  // namespace motorcade
