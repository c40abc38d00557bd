#pragma once

#include <string>
#include <vector>

#include "core/stereo_camera.hpp"

namespace motorcade {

/// Properties that no stereo camera on a car has, such as units other than meters or another image size. Each sentence
/// says how to mend the calibration.
std::vector<std::string> doubtsAbout(const StereoCamera& camera);

/// Properties that a stereo camera may have but seldom does, in sentences that name their possible cause.
std::vector<std::string> odditiesOf(const StereoCamera& camera);

}  // namespace motorcade
