#pragma once

#include <filesystem>
#include <vector>

#include "io/images/image_file.hpp"
#include "io/sequence/sequence.hpp"

/// The values of --camera and --calibration.
namespace motorcade {

/// The same with absolute paths, so that it can be used from elsewhere.
GivenCameras absolute(const GivenCameras& given);

/// The camera that the user gives: five numbers, a KITTI calibration (*.txt) or that of a pair that is not rectified,
/// with which the sequence gets its rectification. Throws UsageError or InputError.
StereoCamera givenCamera(Sequence& sequence, const GivenCameras& given, ImageSize size);

}  // namespace motorcade
