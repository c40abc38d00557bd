#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/stereo_camera.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// The first line of `run` and `check`: layout, frames, camera, and the calibration in force.
std::string sequenceLine(const Sequence& sequence, const FrameRange& range);

/// Properties that no stereo camera on a car has, such as units other than meters or another image size. Each sentence
/// says how to mend the calibration.
std::vector<std::string> doubtsAbout(const StereoCamera& camera);

/// Properties that a stereo camera may have but seldom does, in sentences that name their possible cause.
std::vector<std::string> odditiesOf(const StereoCamera& camera);

/// A sentence if a sequence's gray images look like a color sensor's mosaic and are not declared as one. It looks at
/// the files, before any rectification, of up to `pairs` of the first twenty pairs. All of them must look so. Empty for
/// a stream.
std::optional<std::string> mosaicDoubt(const Sequence& sequence, const FrameRange& selected, std::size_t pairs);

}  // namespace motorcade
