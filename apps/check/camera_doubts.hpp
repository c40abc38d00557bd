#pragma once

#include <string>
#include <vector>

#include "core/stereo_camera.hpp"

namespace motorcade {

/// What of a calibration no stereo camera on a car has, in sentences that say how to mend it: units other than meters,
/// another image size.
std::vector<std::string> doubtsAbout(const StereoCamera& camera);

/// What a stereo camera may have but seldom does, in sentences that say what it may come from.
std::vector<std::string> odditiesOf(const StereoCamera& camera);

}  // namespace motorcade
