#include "apps/pipeline/pipeline.hpp"

#include <cassert>
#include <exception>
#include <thread>
#include <utility>

#include "apps/pipeline/flow_graph.hpp"
#include "apps/pipeline/intake.hpp"
#include "apps/pipeline/job.hpp"
#include "apps/pipeline/publisher.hpp"
#include "apps/pipeline/stage_runner.hpp"

namespace motorcade {

/// Intake -> pump -> flow graph -> publisher. Jobs circulate: the publisher gives them back to the intake.
class Pipeline::Impl {
 public:
  Impl(const PipelineParams& params, Stages stages, const LogCallback& log);
  ~Impl();

  Intake& intake() { return intake_; }
  Publisher& publisher() { return publisher_; }
  PipelineEnd finish();
  PipelineState state() const;
  void abandon();

 private:
  void pump();
  void stop();
  std::vector<QueueMark> queues() const;

  PipelineParams params_;
  FreeJobs free_jobs_;
  Entrance entrance_;
  Intake intake_;
  StageRunner stages_;
  Publisher publisher_;
  FlowGraph graph_;
  bool ended_ = false;
  std::jthread pump_thread_;
};

Pipeline::Impl::Impl(const PipelineParams& params, Stages stages, const LogCallback& log)
    : params_(params),
      free_jobs_(tokens(params)),
      intake_(params, free_jobs_, entrance_, log),
      stages_(std::move(stages), log),
      publisher_(params, free_jobs_),
      graph_(params, {.stages = stages_, .publisher = publisher_, .entrance = entrance_, .stop = [this] { stop(); }}),
      pump_thread_([this] { pump(); }) {}

Pipeline::Impl::~Impl() { abandon(); }

/// Lets the jobs in flight come out at once, but for the stages at work.
void Pipeline::Impl::abandon() {
  graph_.abandon();
  stop();
}

/// Ends all waits for frames, jobs and results.
void Pipeline::Impl::stop() {
  intake_.close();
  free_jobs_.close();
  publisher_.close();
}

void Pipeline::Impl::pump() {
  const PlacedThread placed(params_.placement);
  try {
    while (Job* const job = intake_.next([this] { return graph_.failed(); })) graph_.put(*job);
  } catch (...) {
    graph_.fail(std::current_exception());
  }
  graph_.close();
}

PipelineEnd Pipeline::Impl::finish() {
  assert(!ended_);
  ended_ = true;
  intake_.close();
  PipelineEnd end;
  while (auto result = publisher_.next()) end.results.push_back(std::move(*result));
  pump_thread_.join();
  graph_.join();
  end.dropped = publisher_.lastDropped(intake_.missedAtLast());
  end.finals = publisher_.lastFinals(stages_.finish());
  end.summary = publisher_.summary();
  end.summary.received = intake_.received();
  end.summary.dropped = intake_.dropped();
  end.summary.rejected += intake_.refused();
  end.summary.late = intake_.late();
  end.summary.causes[static_cast<std::size_t>(FrameCause::kTooLate)] += end.summary.dropped;
  end.summary.causes[static_cast<std::size_t>(FrameCause::kOutOfOrder)] += intake_.refused();
  end.summary.queues = queues();
  return end;
}

/// High-water marks of the queues in the order of the data.
std::vector<QueueMark> Pipeline::Impl::queues() const {
  const std::int64_t bound = params_.frames_in_flight;
  std::vector<QueueMark> marks = graph_.queues(bound);
  marks.insert(marks.begin(), {"input>admit", static_cast<std::int64_t>(intake_.highWater()), bound});
  marks.push_back({"publish>output", static_cast<std::int64_t>(publisher_.highWater()), bound});
  return marks;
}

PipelineState Pipeline::Impl::state() const {
  const std::int64_t bound = params_.frames_in_flight;
  PipelineState state{.received = intake_.received(), .queues = graph_.depths(bound)};
  state.queues.insert(state.queues.begin(), {"input>admit", static_cast<std::int64_t>(intake_.waiting()), bound});
  state.queues.push_back({"publish>output", static_cast<std::int64_t>(publisher_.waiting()), bound});
  return state;
}

Pipeline::Pipeline(const PipelineParams& params, Stages stages, LogCallback log) {
  if (!log) log = [](LogLevel, const std::string&) {};
  impl_ = std::make_unique<Impl>(requireValid(params), std::move(stages), log);
}
Pipeline::~Pipeline() = default;

Admission Pipeline::push(StereoFrame frame) { return impl_->intake().push(std::move(frame)); }
void Pipeline::passOver(FrameId frame, Timestamp stamp) { impl_->intake().passOver(frame, stamp); }
void Pipeline::abandon() { impl_->abandon(); }
void Pipeline::close() { impl_->intake().close(); }
std::optional<PipelineResult> Pipeline::next() { return impl_->publisher().next(); }
std::optional<PipelineResult> Pipeline::poll() { return impl_->publisher().poll(); }
PipelineState Pipeline::state() const { return impl_->state(); }
PipelineEnd Pipeline::finish() { return impl_->finish(); }

}  // namespace motorcade
