#include "apps/pipeline/pipeline_params.hpp"

#include <algorithm>
#include <bit>

namespace motorcade {

std::vector<Parameter> parametersOf(PipelineParams& params) {
  return {numberParameter("threads", params.threads, {1, 64}, "workers: more are faster, up to one per processor"),
          numberParameter("frames_in_flight", params.frames_in_flight, {1, 64},
                          "more keep all workers busy, fewer shorten the wait of a frame"),
          choiceParameter<InputPolicy>("policy", params.policy,
                                       {{"replay", InputPolicy::kReplay}, {"live", InputPolicy::kLive}},
                                       "replay drops nothing; live takes the newest pair and never waits")};
}

std::size_t ringCapacity(const PipelineParams& params) {
  return std::bit_floor(static_cast<std::size_t>(params.frames_in_flight));
}

std::size_t tokens(const PipelineParams& params) {
  const bool live = params.policy == InputPolicy::kLive;
  return static_cast<std::size_t>(live ? std::min(params.frames_in_flight, params.threads) : params.frames_in_flight);
}

}  // namespace motorcade
