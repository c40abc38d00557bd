#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "apps/pipeline/pipeline_result.hpp"

namespace motorcade {

/// Counts the good frames of a run, and keeps the reason why others are not good.
class FollowedFrames {
 public:
  void observe(const PipelineResult& result);
  std::int64_t count() const { return count_; }
  /// True when no motion was measured although there were frames. The first frame alone has none, and is good all the
  /// same.
  bool none(const PipelineSummary& summary) const;
  /// A sentence on such a run: the number of frames, the outcome of most of them, and the reason for the first of
  /// those.
  std::string whyNone(const PipelineSummary& summary) const;

 private:
  std::int64_t count_ = 0;
  std::array<std::string, kCauseCount> first_problems_;
};

}  // namespace motorcade
