#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "apps/pipeline/gap_filler.hpp"
#include "apps/pipeline/job.hpp"
#include "apps/pipeline/pipeline_params.hpp"
#include "apps/pipeline/pipeline_result.hpp"
#include "core/messages.hpp"
#include "core/spsc_ring.hpp"

namespace motorcade {

/// Fills in the time since each object was first followed. Call it in frame order, for online and final estimates
/// apart.
class ObjectAges {
 public:
  void fill(FrameEstimate& estimate);

 private:
  struct Life {
    Timestamp first, last;
  };
  std::map<TrackId, Life> lives_;
};

/// The output of results: copies the facts of a finished job, hands them to the consumer and gives the job back.
class Publisher {
 public:
  Publisher(const PipelineParams& params, FreeJobs& free_jobs);

  /// Publishes a job. Call it in frame order; it waits while the consumer is behind.
  void publish(Job& job);
  /// Closes the results: no further one comes, or none will be taken.
  void close() { results_.close(); }

  /// Consumer: the next result, waiting for it; empty after the last one.
  std::optional<PipelineResult> next() { return results_.pop(); }
  /// Consumer: the next result if there is one already.
  std::optional<PipelineResult> poll() { return results_.tryPop(); }

  /// Estimates of the frames that came after the last `publish` and never entered.
  std::vector<FrameEstimate> lastDropped(const std::vector<MissedFrame>& frames) { return gaps_.fill(frames); }
  /// All frames that are not final yet, oldest first; call it after `lastDropped`. `last` are the back-end's.
  std::vector<FrameEstimate> lastFinals(const std::vector<FrameEstimate>& last);
  const PipelineSummary& summary() const { return summary_; }
  /// Any thread: results that were not taken yet.
  std::size_t waiting() const { return results_.size(); }
  std::size_t highWater() const { return results_.highWater(); }

 private:
  PipelineResult resultOf(Job& job);
  std::vector<FrameEstimate> settledOf(const Estimates& estimates);
  void count(const Job& job, const PipelineResult& result);

  FreeJobs& free_jobs_;
  SpscRing<PipelineResult> results_;
  GapFiller gaps_, settled_gaps_;
  FrameId last_settled_;
  ObjectAges online_ages_, settled_ages_, final_ages_;
  PipelineSummary summary_;
};

}  // namespace motorcade
