#pragma once

#include <vector>

#include "core/timestamp.hpp"
#include "io/ground_truth.hpp"
#include "io/sequence.hpp"

namespace motorcade {

/// Poses of the inertial unit with the attitudes of its packets and the places to which their velocities lead from the
/// first one, each packet's velocity and the next one's averaged over the time between them. Throws InputError, naming
/// the file that the packets come from, where one has no velocity.
std::vector<SE3> velocityPoses(const std::vector<OxtsPacket>& packets, const std::vector<Timestamp>& stamps,
                               const std::filesystem::path& file);

/// When the packets of a sequence were taken: as their own file of times tells, else when the images were, one for
/// each. Throws InputError where neither is known: velocities at an assumed rate would lead to a path of a wrong
/// length.
std::vector<Timestamp> packetStamps(const Sequence& sequence, std::size_t packets);

}  // namespace motorcade
