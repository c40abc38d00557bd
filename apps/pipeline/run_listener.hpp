#pragma once

#include <vector>

#include "apps/pipeline/pipeline_result.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Follows a run while it goes on, to show it or to write a file of its own. Neither call may wait. Only the second may
/// in a replay that has to wait for a writer.
class RunListener {
 public:
  virtual ~RunListener() = default;
  /// Called on the thread of the replay when a pair has gone into the pipeline. Its images belong to a pool; keep few
  /// of them.
  virtual void frameEntered(const StereoFrame& frame) = 0;
  /// Called on the thread that takes the results, in frame order.
  virtual void frameLeft(const PipelineResult& result) = 0;
};

/// The listeners of a run, which owns none of them.
using RunListeners = std::vector<RunListener*>;

}  // namespace motorcade
