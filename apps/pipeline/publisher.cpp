#include "apps/pipeline/publisher.hpp"

#include <chrono>
#include <string>
#include <utility>

namespace motorcade {
namespace {

/// What went wrong with the frame, in the order of the stages; the job forgets it.
std::string takeProblems(Job& job) {
  std::string text = job.frame->problem;
  for (std::string& problem : job.problems)
    if (!problem.empty()) text += (text.empty() ? "" : "; ") + std::exchange(problem, {});
  return text;
}

}  // namespace

Publisher::Publisher(const PipelineParams& params, FreeJobs& free_jobs)
    : free_jobs_(free_jobs), results_(ringCapacity(params)) {}

void Publisher::publish(Job& job) {
  PipelineResult result = resultOf(job);
  results_.waitForRoom();
  job.timing.published = std::chrono::steady_clock::now();
  job.timing.status = result.online.status;
  result.timing = job.timing;
  count(job, result);
  results_.tryPush(result);
  job.clear();
  free_jobs_.giveBack(job);
}

PipelineResult Publisher::resultOf(Job& job) {
  PipelineResult result;
  const bool seen_by_backend = job.problemOf(Stage::kIncrementalOptimization).empty();
  result.dropped = gaps_.fill(job.dropped, FrameStatus::kDropped);
  result.online = job.estimates->online;
  online_ages_.fill(result.online);
  if (!seen_by_backend) result.online.T_world_cam = gaps_.predict(job.timing.stamp);
  gaps_.published(result.online, seen_by_backend);
  result.finals = gaps_.completed(job.estimates->finals);
  for (FrameEstimate& estimate : result.finals) final_ages_.fill(estimate);
  result.masks = job.estimates->masks;
  result.measurements = job.measurements;
  result.counters = job.estimates->counters;
  result.problem = takeProblems(job);
  return result;
}

void Publisher::count(const Job& job, const PipelineResult& result) {
  const FrameStatus status = result.online.status;
  ++(status == FrameStatus::kRejected ? summary_.rejected : summary_.processed);
  if (status == FrameStatus::kLost) ++summary_.lost;
  summary_.latency.add(job.timing.latency_ms());
  summary_.latency_with_decoding.add(job.timing.latency_ms() + job.timing.decode_ms);
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    summary_.stages[stage].add(job.timing.stages[stage].duration_ms());
  if (result.problem.empty() || result.counters.updates > 0) summary_.solver = result.counters;
}

std::vector<FrameEstimate> Publisher::lastFinals(const std::vector<FrameEstimate>& last) {
  std::vector<FrameEstimate> finals = gaps_.completed(last);
  for (FrameEstimate& estimate : gaps_.rest()) finals.push_back(std::move(estimate));
  for (FrameEstimate& estimate : finals) final_ages_.fill(estimate);
  return finals;
}

}  // namespace motorcade
