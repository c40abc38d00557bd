#include "apps/pipeline/publisher.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <string>
#include <utility>

namespace motorcade {

void ObjectAges::fill(FrameEstimate& estimate) {
  constexpr double kGone_s = 60;  // far longer than an object that is found again was away
  std::erase_if(lives_,
                [&](const auto& life) { return secondsBetween(life.second.last, estimate.head.stamp) > kGone_s; });
  for (ObjectEstimate& object : estimate.objects) {
    Life& life = lives_.try_emplace(object.track, Life{estimate.head.stamp, estimate.head.stamp}).first->second;
    life.last = estimate.head.stamp;
    object.age_s = secondsBetween(life.first, life.last);
  }
}

namespace {

/// Takes the problems of the frame out of the job, in the order of the stages.
std::string takeProblems(Job& job) {
  std::string text = job.frame->problem;
  for (std::string& problem : job.problems)
    if (!problem.empty()) text += (text.empty() ? "" : "; ") + std::exchange(problem, {});
  return text;
}

void countWhatWasSeen(const PipelineResult& result, FrameTiming& timing) {
  const FrameMeasurements& seen = *result.measurements;
  timing.inliers = static_cast<int>(seen.at_rest.size());
  timing.points = timing.inliers + static_cast<int>(seen.undecided.size());
  for (const ObjectObservation& object : seen.objects)
    if (object.frame == seen.head.frame) timing.points += static_cast<int>(object.measured.size());
  timing.objects = static_cast<int>(result.online.objects.size());
}

}  // namespace

Publisher::Publisher(const PipelineParams& params, FreeJobs& free_jobs)
    : free_jobs_(free_jobs), results_(ringCapacity(params)) {}

void Publisher::publish(Job& job) {
  PipelineResult result = resultOf(job);
  results_.waitForRoom();
  job.timing.published = std::chrono::steady_clock::now();
  job.timing.head = result.online.head;
  countWhatWasSeen(result, job.timing);
  result.timing = job.timing;
  count(job, result);
  results_.tryPush(result);
  job.clear();
  free_jobs_.giveBack(job);
}

PipelineResult Publisher::resultOf(Job& job) {
  PipelineResult result;
  const bool seen_by_backend = job.problemOf(Stage::kIncrementalOptimization).empty();
  result.dropped = gaps_.fill(job.dropped);
  settled_gaps_.fill(job.dropped);
  result.dropped_unnamed = job.dropped_unnamed;
  result.online = job.estimates->online;
  online_ages_.fill(result.online);
  if (!seen_by_backend) result.online.T_world_cam = gaps_.predict(job.timing.head.stamp);
  gaps_.published(result.online, seen_by_backend);
  settled_gaps_.published(result.online, seen_by_backend);
  result.finals = gaps_.completed(job.estimates->finals);
  for (FrameEstimate& estimate : result.finals) final_ages_.fill(estimate);
  result.settled = settledOf(*job.estimates);
  result.masks = job.estimates->masks;
  result.measurements = job.measurements;
  result.counters = job.estimates->counters;
  result.problem = takeProblems(job);
  return result;
}

/// Settled estimates; a frame that leaves the window earlier is final by then.
std::vector<FrameEstimate> Publisher::settledOf(const Estimates& estimates) {
  std::vector<FrameEstimate> settled = estimates.settled;
  if (!settled.empty()) last_settled_ = settled.back().head.frame;
  std::ranges::copy_if(estimates.finals, std::back_inserter(settled),
                       [this](const FrameEstimate& final) { return final.head.frame > last_settled_; });
  if (!settled.empty()) last_settled_ = settled.back().head.frame;
  settled = settled_gaps_.completed(settled);
  for (FrameEstimate& estimate : settled) settled_ages_.fill(estimate);
  return settled;
}

void Publisher::count(const Job& job, const PipelineResult& result) {
  const FrameStatus status = result.online.head.status;
  ++(status == FrameStatus::kRejected ? summary_.rejected : summary_.processed);
  if (status == FrameStatus::kLost) ++summary_.lost;
  if (status == FrameStatus::kGood && result.online.head.cause != FrameCause::kNone) ++summary_.degraded;
  ++summary_.causes[static_cast<std::size_t>(result.online.head.cause)];
  summary_.segments = result.online.head.segment + 1;
  summary_.latency.add(job.timing.latency_ms());
  summary_.latency_with_decoding.add(job.timing.latency_ms() + job.timing.decode_ms);
  summary_.entry_wait.add(job.timing.entry_wait_ms());
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    summary_.stages[stage].add(job.timing.stages[stage].duration_ms());
    summary_.waits[stage].add(job.timing.wait_ms(static_cast<Stage>(stage)));
    summary_.cpu[stage].add(job.timing.stages[stage].cpu_ms);
  }
  if (result.problem.empty() || result.counters.updates > 0) summary_.solver = result.counters;
}

std::vector<FrameEstimate> Publisher::lastFinals(const std::vector<FrameEstimate>& last) {
  std::vector<FrameEstimate> finals = gaps_.completed(last);
  for (FrameEstimate& estimate : gaps_.rest()) finals.push_back(std::move(estimate));
  for (FrameEstimate& estimate : finals) final_ages_.fill(estimate);
  return finals;
}

}  // namespace motorcade
