#pragma once

#include <vector>

#include "core/timestamp.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/ground_truth.hpp"

namespace motorcade {

/// Poses of the inertial unit with the attitudes of its packets. The positions integrate the packets' velocities from
/// the first one by the trapezoidal rule. Throws InputError naming the packets' file where one has no velocity.
std::vector<SE3> velocityPoses(const std::vector<OxtsPacket>& packets, const std::vector<Timestamp>& stamps,
                               const std::filesystem::path& file);

/// Capture times of a sequence's packets, one for each: from their own file of times, else those of the images. Throws
/// InputError where neither is known or the number of times is not `packets`. An assumed rate would give a path of the
/// wrong length.
std::vector<Timestamp> packetStamps(const Sequence& sequence, std::size_t packets);

}  // namespace motorcade
