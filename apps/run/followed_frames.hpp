#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "apps/pipeline/pipeline_result.hpp"

namespace motorcade {

/// Counts the good frames of a run, and remembers why others are not.
class FollowedFrames {
 public:
  void observe(const PipelineResult& result);
  std::int64_t count() const { return count_; }
  /// No motion was measured, while there were frames: the first one alone has none, and is good all the same.
  bool none(const PipelineSummary& summary) const;
  /// A sentence on such a run: how many frames there were, what became of most of them, and why of the first of those.
  std::string whyNone(const PipelineSummary& summary) const;

 private:
  std::int64_t count_ = 0;
  std::array<std::string, kCauseCount> first_problems_;
};

}  // namespace motorcade
