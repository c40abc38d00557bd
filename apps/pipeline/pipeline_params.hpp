#pragma once

#include <vector>

#include "core/parameters.hpp"

namespace motorcade {

enum class InputPolicy {
  kReplay,  // nothing is dropped: the producer waits when the pipeline is behind
  kLive,    // the newest pair wins: the producer never waits, pairs that nobody took are dropped
};

struct PipelineParams {
  int threads = 2;           // workers of the pipeline's own arena, at most one per processor
  int frames_in_flight = 4;  // bound of every queue; live: at most `threads`, so that frames do not grow old on the way
  InputPolicy policy = InputPolicy::kReplay;
};

std::vector<Parameter> parametersOf(PipelineParams& params);

}  // namespace motorcade
