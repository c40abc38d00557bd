#pragma once

#include "apps/pipeline/log_callback.hpp"
#include "apps/pipeline/pipeline_config.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// A caller's options as the pipeline takes them. Throws Error naming the field.
PipelineConfig configOf(const Tracker::Options& options);

/// The caller's log, from which no exception comes.
LogCallback logOf(const Tracker::Options& options);

}  // namespace motorcade
