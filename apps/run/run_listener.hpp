#pragma once

#include <vector>

#include "apps/pipeline/pipeline_result.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Follows a run while it goes on, to show it or to send more of it to a file of its own. Neither call may wait for
/// anybody, but that the second may where a replay is to wait for what is written.
class RunListener {
 public:
  virtual ~RunListener() = default;
  /// On the thread of the replay: a pair has gone into the pipeline. Its images belong to a pool; keep few of them.
  virtual void frameEntered(const StereoFrame& frame) = 0;
  /// On the thread that takes the results, in frame order.
  virtual void frameLeft(const PipelineResult& result) = 0;
};

/// Those of a run, which owns none of them.
using RunListeners = std::vector<RunListener*>;

}  // namespace motorcade
