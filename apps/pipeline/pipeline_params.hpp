#pragma once

#include <cstddef>
#include <vector>

#include "core/parameters.hpp"
#include "core/thread_placement.hpp"

namespace motorcade {

enum class InputPolicy {
  kReplay,  // nothing is dropped: the producer waits when the pipeline is behind
  kLive,    // the newest pair wins: the producer never waits, pairs that were not taken are dropped
};

struct PipelineParams {
  int threads = 2;           // workers of the pipeline's own arena, at most one per processor
  int frames_in_flight = 4;  // bound of every queue; live: at most `threads`, so that frames do not grow old on the way
  InputPolicy policy = InputPolicy::kReplay;
  ThreadPlacement placement{};  // of the pipeline's threads; no key of the configuration
};

std::vector<Parameter> parametersOf(PipelineParams& params);

/// Capacity of the rings at both ends. Rings round up to a power of two: this much stays within the bound.
std::size_t ringCapacity(const PipelineParams& params);
/// Most frames in the flow graph at once. In live, frames beyond those that the workers can work on would only grow old
/// between the stages.
std::size_t tokens(const PipelineParams& params);

}  // namespace motorcade
