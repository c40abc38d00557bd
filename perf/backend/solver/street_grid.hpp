#pragma once

#include <cstdint>

#include "io/results/pose_graph.hpp"

namespace motorcade::perf {

/// A drive through a grid of streets, of the kind of the public graphs `city10000` and `manhattan`: steps of a meter,
/// quarter turns at random crossings, and an edge to an earlier pose at the same place wherever one was. Measurements
/// have white noise.
PoseGraph streetGrid(int poses, std::uint64_t seed);

}  // namespace motorcade::perf
