#pragma once

#include <string>
#include <vector>

#include "core/stereo_camera.hpp"

namespace motorcade {

/// What of a calibration no stereo camera on a car has, in sentences that say how to mend it: units other than meters,
/// another image size.
std::vector<std::string> doubtsAbout(const StereoCamera& camera);

/// Properties that a stereo camera may have but seldom does, in sentences that name their possible cause.
std::vector<std::string> odditiesOf(const StereoCamera& camera);

}  // namespace motorcade
