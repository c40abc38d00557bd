#pragma once

#include "apps/pipeline/log_callback.hpp"
#include "apps/pipeline/pipeline_config.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// A caller's options as the pipeline takes them, with what the camera says of itself where its settings do not. Throws
/// Error naming the field.
PipelineConfig configOf(const Tracker::Options& options, const Camera& camera);

/// The caller's log, from which no exception comes.
LogCallback logOf(const Tracker::Options& options);

}  // namespace motorcade
