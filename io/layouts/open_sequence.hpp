#pragma once

#include <filesystem>

#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Finds out what lies in a folder:
///   plain      two folders of images (image_0 + image_1, image_00 + image_01, image_2 + image_3, image_02 + image_03,
///              left + right or cam0 + cam1), with calib.txt or the calibration of a pair that is not rectified
///   odometry   a plain folder sequences/NN whose poses are in poses/NN.txt
///   tracking   .../training/image_02/0003, or .../training/0003 for short;
///              calib/0003.txt, oxts/0003.txt, label_02/0003.txt
///   raw        DATE/DATE_drive_NNNN_sync with image_00/data; DATE/calib_cam_to_cam.txt
///   euroc      the folder mav0, or the one that holds it, with cam0 and cam1
///   kitti360   data_2d_raw/DATE_drive_NNNN_sync with image_00/data_rect; calibration/perspective.txt
///   virtual_kitti  Scene01/clone with frames/rgb/Camera_0; intrinsic.txt, extrinsic.txt
///   argoverse  a log with stereo_front_left_rect and stereo_front_right_rect
///   list       a text file with a line LEFT RIGHT or STAMP LEFT RIGHT for each pair
///
/// Where gray and color images are both there, the gray ones are taken. Without times, frames come at `fps_hz`.
/// Throws InputError naming the file and how to fix it. Single images are not read: a damaged one becomes a rejected
/// frame later.
Sequence openSequence(const std::filesystem::path& path, double fps_hz = 10, const GivenCameras& given = {});

}  // namespace motorcade
