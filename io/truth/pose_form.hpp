#pragma once

#include <filesystem>
#include <vector>

#include "io/files/text_file.hpp"

namespace motorcade {

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
