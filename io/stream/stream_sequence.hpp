#pragma once

#include <string>

#include "io/sequence/sequence.hpp"
#include "io/stream/stereo_packing.hpp"
#include "io/stream/y4m_header.hpp"

namespace motorcade {

/// A stream's drive as known before its first pair: all but the frames and their times. A pipe brings no calibration:
/// the user gives it. Throws InputError or UsageError.
Sequence sequenceOfStream(const Y4mHeader& header, StereoPacking packing, const GivenCameras& given);

}  // namespace motorcade
