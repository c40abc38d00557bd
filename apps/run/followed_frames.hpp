#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "apps/pipeline/pipeline_result.hpp"

namespace motorcade {

/// Counts the frames of a run whose motion was measured, and remembers why others were not.
class FollowedFrames {
 public:
  void observe(const PipelineResult& result);
  std::int64_t count() const { return count_; }
  /// A sentence on a run without any: how many frames there were, what became of most of them, and of which the first
  /// one was told.
  std::string whyNone(const PipelineSummary& summary) const;

 private:
  std::int64_t count_ = 0;
  std::array<std::string, kCauseCount> first_problems_;
};

}  // namespace motorcade
