#include "apps/pipeline/pipeline_params.hpp"

namespace motorcade {

std::vector<Parameter> parametersOf(PipelineParams& params) {
  return {numberParameter("threads", params.threads, {1, 64}, "workers: more are faster, up to one per processor"),
          numberParameter("frames_in_flight", params.frames_in_flight, {1, 64},
                          "more keep all workers busy, fewer shorten the wait of a frame"),
          choiceParameter<InputPolicy>("policy", params.policy,
                                       {{"replay", InputPolicy::kReplay}, {"live", InputPolicy::kLive}},
                                       "replay drops nothing; live takes the newest pair and never waits")};
}

}  // namespace motorcade
