#pragma once

#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/log_callback.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// A caller's options as the pipeline takes them. The camera's own values apply where the settings have none. Throws
/// Error naming the field.
PipelineConfig configOf(const Tracker::Options& options, const Camera& camera);

/// The caller's log; its exceptions are caught.
LogCallback logOf(const Tracker::Options& options);

}  // namespace motorcade
