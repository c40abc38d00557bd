#include "apps/pipeline/pipeline.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cstddef>
#include <exception>
#include <future>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>

#include "apps/pipeline/edge_gauge.hpp"
#include "core/mailbox.hpp"
#include "core/spsc_ring.hpp"
#include "core/thread_clock.hpp"

namespace motorcade {
namespace {

namespace flow = oneapi::tbb::flow;

/// A token: one of the frames that may be in flight, with the messages that its stages have made so far.
/// Each field has one writer; the graph's edges order writers before readers.
struct Job {
  std::size_t sequence = 0;  // without gaps, unlike the frame's id
  std::vector<FrameHeader> dropped;
  StereoFramePtr frame;
  FeaturesPtr features;
  StereoMatchesPtr stereo;
  OpticalFlowPtr flow;
  SceneMotionPtr motion;
  FrameMeasurementsPtr measurements;
  EstimatesPtr estimates;
  FrameTiming timing;
  std::array<std::string, kStageCount> problems;  // exceptions of the stages
};
using JobPair = std::tuple<Job*, Job*>;  // twice the same job, from the two branches

enum Edge : std::size_t {
  kToPrepare,
  kToStereo,
  kToFlow,
  kStereoToMotion,
  kFlowToMotion,
  kToTracking,
  kToOptimization,
  kToPublish,
  kEdges
};
constexpr std::array<const char*, kEdges> kEdgeNames{"admit>prepare",         "prepare>stereo",      "prepare>flow",
                                                     "stereo>motion",         "flow>motion",         "motion>tracking",
                                                     "tracking>optimization", "optimization>publish"};

SteadyTime now() { return std::chrono::steady_clock::now(); }

/// Rings round their capacity up to a power of two: this much stays within the bound.
std::size_t ringCapacity(const PipelineParams& params) {
  return std::bit_floor(static_cast<std::size_t>(params.frames_in_flight));
}

/// In live, frames beyond those that the workers can work on would only grow old between the stages.
std::size_t tokens(const PipelineParams& params) {
  return static_cast<std::size_t>(params.policy == InputPolicy::kLive
                                      ? std::min(params.frames_in_flight, params.threads)
                                      : params.frames_in_flight);
}

/// Uncertainty of a motion that nobody measured.
Matrix6d unknownMotionCovariance() {
  constexpr double kSigma_m = 1.0, kSigma_rad = 0.1;
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(kSigma_m * kSigma_m), Eigen::Vector3d::Constant(kSigma_rad * kSigma_rad);
  return variances.asDiagonal();
}

}  // namespace

class Pipeline::Impl {
 public:
  Impl(const PipelineParams& params, Stages stages, LogCallback log);
  ~Impl();

  bool push(StereoFrame frame);
  void passOver(const FrameHeader& frame);
  void close();
  std::optional<PipelineResult> next() { return results_.pop(); }
  std::optional<PipelineResult> poll() { return results_.tryPop(); }
  PipelineEnd finish();

 private:
  bool live() const { return params_.policy == InputPolicy::kLive; }
  void runGraph(std::promise<void>& ready);
  void pump();
  void waitForEntrance() const;
  void openEntrance();
  void admit(Job& job, StereoFrame frame);
  std::vector<FrameHeader> droppedBefore(FrameId frame);

  void prepare(Job& job);
  void matchStereo(Job& job);
  void follow(Job& job);
  void estimateMotion(Job& job);
  void track(Job& job);
  void optimize(Job& job);
  void publish(Job& job);
  template <class Run, class Rescue>
  auto attempt(Job& job, Stage stage, const Run& run, const Rescue& rescue);
  void count(const Job& job, const PipelineResult& result);
  void clear(Job& job);

  PipelineParams params_;
  Stages stages_;
  LogCallback log_;

  // Input: the ring in replay; in live the mailbox, and the headers of all frames to know those that it lost.
  SpscRing<StereoFrame> input_;
  Mailbox<StereoFrame> newest_;
  SpscRing<FrameHeader> headers_;
  std::optional<FrameHeader> header_ahead_;  // taken from `headers_`, later than the newest frame
  std::atomic<std::int64_t> received_{0}, passed_over_{0};
  FrameId next_id_{0};  // producer only

  // In flight.
  std::vector<Job> jobs_;
  SpscRing<Job*> free_jobs_;
  std::array<EdgeGauge, kEdges> gauges_;
  std::size_t admitted_ = 0;                   // pump only
  std::atomic<std::size_t> past_entrance_{0};  // frames that have left the motion stage, live only
  SE3 last_motion_;                            // motion stage only

  // Output, publish stage only until the graph has ended.
  SpscRing<PipelineResult> results_;
  GapFiller gaps_;
  PipelineSummary summary_;

  oneapi::tbb::task_arena arena_;
  flow::graph* graph_ = nullptr;  // on the stack of `runGraph`
  flow::receiver<Job*>* first_node_ = nullptr;
  bool ended_ = false;
  std::jthread graph_thread_, pump_thread_;
};

Pipeline::Impl::Impl(const PipelineParams& params, Stages stages, LogCallback log)
    : params_(params),
      stages_(std::move(stages)),
      log_(log ? std::move(log) : [](LogLevel, const std::string&) {}),
      input_(ringCapacity(params)),
      headers_(params.policy == InputPolicy::kLive ? 4096 : 1),
      jobs_(tokens(params)),
      free_jobs_(jobs_.size()),
      results_(ringCapacity(params)),
      // One slot is reserved for the thread of `runGraph`, which works too: together they are `threads` workers.
      arena_(std::min(params.threads, oneapi::tbb::info::default_concurrency()), 1) {
  for (Job& job : jobs_) free_jobs_.push(&job);
  std::promise<void> ready;
  auto wired = ready.get_future();
  graph_thread_ = std::jthread([this, &ready] { arena_.execute([this, &ready] { runGraph(ready); }); });
  wired.get();
  pump_thread_ = std::jthread([this] { pump(); });
}

Pipeline::Impl::~Impl() {
  close();
  free_jobs_.close();
  results_.close();
}

/// The wiring: stateless stages `unlimited`, stages with memory `serial` behind a sequencer (a serial node may start
/// its next message before it has handed on the last one). Stays in the graph until the pump has let go of it and all
/// frames are out.
void Pipeline::Impl::runGraph(std::promise<void>& ready) {
  const auto sequence = [](const Job* job) { return job->sequence; };
  const auto stage = [this](void (Impl::*work)(Job&)) {
    return [this, work](Job* job) {
      (this->*work)(*job);
      return job;
    };
  };
  using Node = flow::function_node<Job*, Job*>;
  using InOrder = flow::sequencer_node<Job*>;

  flow::graph graph;
  Node prepare(graph, flow::unlimited, stage(&Impl::prepare));
  Node stereo(graph, flow::unlimited, stage(&Impl::matchStereo));
  InOrder flow_order(graph, sequence);
  Node follow(graph, flow::serial, stage(&Impl::follow));
  flow::join_node<JobPair, flow::key_matching<std::size_t>> both(graph, sequence, sequence);
  flow::sequencer_node<JobPair> motion_order(graph, [](const JobPair& pair) { return std::get<0>(pair)->sequence; });
  flow::function_node<JobPair, Job*> motion(graph, flow::serial, [this](const JobPair& pair) {
    estimateMotion(*std::get<0>(pair));
    return std::get<0>(pair);
  });
  InOrder tracking_order(graph, sequence);
  Node tracking(graph, flow::serial, stage(&Impl::track));
  InOrder optimization_order(graph, sequence);
  Node optimization(graph, flow::serial, stage(&Impl::optimize));
  InOrder publish_order(graph, sequence);
  flow::function_node<Job*, flow::continue_msg> publish(graph, flow::serial, [this](Job* job) { this->publish(*job); });

  flow::make_edge(prepare, stereo);
  flow::make_edge(prepare, flow_order);
  flow::make_edge(flow_order, follow);
  flow::make_edge(stereo, flow::input_port<0>(both));
  flow::make_edge(follow, flow::input_port<1>(both));
  flow::make_edge(both, motion_order);
  flow::make_edge(motion_order, motion);
  flow::make_edge(motion, tracking_order);
  flow::make_edge(tracking_order, tracking);
  flow::make_edge(tracking, optimization_order);
  flow::make_edge(optimization_order, optimization);
  flow::make_edge(optimization, publish_order);
  flow::make_edge(publish_order, publish);

  first_node_ = &prepare;
  graph_ = &graph;
  graph.reserve_wait();
  ready.set_value();
  graph.wait_for_all();
  results_.close();
}

// ---- Input
// -------------------------------------------------------------------------------------------------------------------

bool Pipeline::Impl::push(StereoFrame frame) {
  if (input_.closed()) return false;
  if (!frame.frame.valid()) frame.frame = next_id_;
  assert(frame.frame >= next_id_);
  next_id_ = {frame.frame.value + 1};
  if (live()) {
    FrameHeader header{frame.frame, frame.stamp};
    headers_.tryPush(header);
    newest_.put(std::move(frame));
  } else if (!input_.push(std::move(frame))) {
    return false;
  }
  received_.fetch_add(1, std::memory_order_relaxed);
  return true;
}

void Pipeline::Impl::passOver(const FrameHeader& frame) {
  assert(live() && frame.frame >= next_id_);
  if (input_.closed()) return;
  next_id_ = {frame.frame.value + 1};
  FrameHeader header = frame;
  headers_.tryPush(header);
  passed_over_.fetch_add(1, std::memory_order_relaxed);
  received_.fetch_add(1, std::memory_order_relaxed);
}

void Pipeline::Impl::close() {
  input_.close();
  newest_.close();
}

/// Takes a token first, then a frame: so the frame is the newest one when the policy is live.
void Pipeline::Impl::pump() {
  while (const auto job = free_jobs_.pop()) {
    if (live()) waitForEntrance();
    auto frame = live() ? newest_.take() : input_.pop();
    if (!frame) break;
    admit(**job, std::move(*frame));
  }
  graph_->release_wait();
}

/// In live, a frame is admitted when the one before it has left the stages whose loops keep every worker busy: admitted
/// earlier it would only slow that one down and grow old, while in the mailbox the newest frame takes its place. Each
/// admitted frame gets that far, so the wait ends.
void Pipeline::Impl::waitForEntrance() const {
  for (auto past = past_entrance_.load(std::memory_order_acquire); past < admitted_;
       past = past_entrance_.load(std::memory_order_acquire))
    past_entrance_.wait(past, std::memory_order_acquire);
}

void Pipeline::Impl::openEntrance() {
  past_entrance_.fetch_add(1, std::memory_order_release);
  past_entrance_.notify_one();
}

void Pipeline::Impl::admit(Job& job, StereoFrame frame) {
  job.timing = FrameTiming{};
  job.timing.admitted = now();
  if (frame.due == SteadyTime{}) frame.due = job.timing.admitted;
  job.timing.frame = frame.frame;
  job.timing.stamp = frame.stamp;
  job.timing.due = frame.due;
  job.timing.decode_ms = frame.decode_ms;
  if (frame.rejected())
    log_(LogLevel::kWarning, "frame " + std::to_string(frame.frame.value) + " is rejected: " + frame.problem);
  if (live()) job.dropped = droppedBefore(frame.frame);
  job.frame = std::make_shared<const StereoFrame>(std::move(frame));
  job.sequence = admitted_++;
  gauges_[kToPrepare].enter();
  first_node_->try_put(&job);  // never refused: the node queues, and there are no more jobs than tokens
}

std::vector<FrameHeader> Pipeline::Impl::droppedBefore(FrameId frame) {
  std::vector<FrameHeader> dropped;
  for (;;) {
    if (!header_ahead_) header_ahead_ = headers_.tryPop();
    if (!header_ahead_ || header_ahead_->frame > frame) return dropped;
    if (header_ahead_->frame < frame) dropped.push_back(*header_ahead_);
    header_ahead_.reset();
  }
}

// ---- Stages
// ------------------------------------------------------------------------------------------------------------------

/// The pipeline's frame boundary: runs a stage, and when it throws makes do with what `rescue` gives. Isolated, so that
/// a stage that waits for its own parallel loop does not begin with a later frame meanwhile.
template <class Run, class Rescue>
auto Pipeline::Impl::attempt(Job& job, Stage stage, const Run& run, const Rescue& rescue) {
  const auto index = static_cast<std::size_t>(stage);
  StageSpan& span = job.timing.stages[index];
  std::string& problem = job.problems[index];
  decltype(run()) message;
  span.worker = oneapi::tbb::this_task_arena::current_thread_index();
  span.start = now();
  const double cpu_before_ms = threadCpu_ms();
  try {
    oneapi::tbb::this_task_arena::isolate([&] { message = run(); });
    if (!message) throw std::logic_error("no message came out");
  } catch (const std::exception& error) {
    problem = error.what();
  } catch (...) {
    problem = "unknown exception";
  }
  if (!problem.empty()) {
    problem = std::string(kStageNames[index]) + " failed: " + problem;
    log_(LogLevel::kError, "frame " + std::to_string(job.timing.frame.value) + ": " + problem);
    message = rescue();
  }
  span.cpu_ms = threadCpu_ms() - cpu_before_ms;
  span.end = now();
  return message;
}

void Pipeline::Impl::prepare(Job& job) {
  gauges_[kToPrepare].leave();
  job.features = attempt(
      job, Stage::kPrepare, [&] { return stages_.prepare(job.frame); },
      [&] {
        StereoFrame rejected{.frame = job.frame->frame,
                             .stamp = job.frame->stamp,
                             .due = job.frame->due,
                             .left = {},
                             .right = {},
                             .problem = {}};
        rejected.problem = job.problems[static_cast<std::size_t>(Stage::kPrepare)];
        Features features;
        features.frame = std::make_shared<const StereoFrame>(std::move(rejected));
        return std::make_shared<const Features>(std::move(features));
      });
  gauges_[kToStereo].enter();
  gauges_[kToFlow].enter();
}

void Pipeline::Impl::matchStereo(Job& job) {
  gauges_[kToStereo].leave();
  job.stereo = attempt(
      job, Stage::kStereo, [&] { return stages_.stereo(job.features); },
      [&] {
        StereoMatches none{.features = job.features, .of_corner = {}};
        none.of_corner.resize(job.features->corners.size());
        return std::make_shared<const StereoMatches>(std::move(none));
      });
  gauges_[kStereoToMotion].enter();
}

void Pipeline::Impl::follow(Job& job) {
  gauges_[kToFlow].leave();
  job.flow = attempt(
      job, Stage::kFlow, [&] { return stages_.flow(job.features); },
      [&] { return std::make_shared<const OpticalFlow>(OpticalFlow{.features = job.features, .observations = {}}); });
  gauges_[kFlowToMotion].enter();
}

void Pipeline::Impl::estimateMotion(Job& job) {
  gauges_[kStereoToMotion].leave();
  gauges_[kFlowToMotion].leave();
  job.motion = attempt(
      job, Stage::kMotion, [&] { return stages_.motion(job.stereo, job.flow); },
      [&] {
        SceneMotion predicted;
        predicted.frame = job.timing.frame;
        predicted.stamp = job.timing.stamp;
        predicted.status = job.features->frame->rejected() ? FrameStatus::kRejected : FrameStatus::kLost;
        predicted.T_previous_now = job.sequence == 0 ? SE3() : last_motion_;
        predicted.odometry_covariance = unknownMotionCovariance();
        return std::make_shared<const SceneMotion>(std::move(predicted));
      });
  last_motion_ = job.motion->T_previous_now;
  if (live()) openEntrance();
  gauges_[kToTracking].enter();
}

void Pipeline::Impl::track(Job& job) {
  gauges_[kToTracking].leave();
  job.measurements = attempt(
      job, Stage::kTracking, [&] { return stages_.tracking(job.motion); },
      [&] {
        FrameMeasurements camera_only;
        camera_only.frame = job.timing.frame;
        camera_only.stamp = job.timing.stamp;
        camera_only.status = job.motion->status == FrameStatus::kGood ? FrameStatus::kLost : job.motion->status;
        camera_only.T_previous_now = job.motion->T_previous_now;
        camera_only.odometry_covariance = job.motion->odometry_covariance;
        return std::make_shared<const FrameMeasurements>(std::move(camera_only));
      });
  gauges_[kToOptimization].enter();
}

void Pipeline::Impl::optimize(Job& job) {
  gauges_[kToOptimization].leave();
  job.estimates = attempt(
      job, Stage::kOptimization, [&] { return stages_.optimization(job.measurements); },
      [&] {
        Estimates lost;  // without a pose: `publish` knows the last one and predicts it
        lost.online.frame = job.timing.frame;
        lost.online.stamp = job.timing.stamp;
        lost.online.status = FrameStatus::kLost;
        return std::make_shared<const Estimates>(std::move(lost));
      });
  for (const std::string& problem : job.estimates->problems)
    log_(LogLevel::kWarning, "frame " + std::to_string(job.timing.frame.value) + ": " + problem);
  gauges_[kToPublish].enter();
}

// ---- Output
// ------------------------------------------------------------------------------------------------------------------

/// Copies the facts, hands them to the consumer and gives the token back.
void Pipeline::Impl::publish(Job& job) {
  gauges_[kToPublish].leave();
  PipelineResult result;
  const bool seen_by_backend = job.problems[static_cast<std::size_t>(Stage::kOptimization)].empty();
  result.dropped = gaps_.fill(job.dropped, FrameStatus::kDropped);
  result.online = job.estimates->online;
  if (!seen_by_backend) result.online.T_world_cam = gaps_.predict(job.timing.stamp);
  gaps_.published(result.online, seen_by_backend);
  result.finals = gaps_.completed(job.estimates->finals);
  result.counters = job.estimates->counters;
  result.problem = job.frame->problem;
  for (std::string& problem : job.problems)
    if (!problem.empty()) result.problem += (result.problem.empty() ? "" : "; ") + std::exchange(problem, {});

  results_.waitForRoom();
  job.timing.published = now();
  job.timing.status = result.online.status;
  result.timing = job.timing;
  count(job, result);
  results_.tryPush(result);
  clear(job);
  free_jobs_.push(&job);
}

void Pipeline::Impl::count(const Job& job, const PipelineResult& result) {
  const FrameStatus status = result.online.status;
  ++(status == FrameStatus::kRejected ? summary_.rejected : summary_.processed);
  if (status == FrameStatus::kLost) ++summary_.lost;
  summary_.latency.add(job.timing.latency_ms());
  summary_.latency_with_decoding.add(job.timing.latency_ms() + job.timing.decode_ms);
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    summary_.stages[stage].add(job.timing.stages[stage].duration_ms());
  if (result.problem.empty() || result.counters.updates > 0) summary_.solver = result.counters;
}

void Pipeline::Impl::clear(Job& job) {
  job.dropped.clear();
  job.frame.reset();
  job.features.reset();
  job.stereo.reset();
  job.flow.reset();
  job.motion.reset();
  job.measurements.reset();
  job.estimates.reset();
}

PipelineEnd Pipeline::Impl::finish() {
  assert(!ended_);
  ended_ = true;
  close();
  PipelineEnd end;
  while (auto result = results_.pop()) end.results.push_back(std::move(*result));
  pump_thread_.join();
  graph_thread_.join();
  try {
    end.finals = gaps_.completed(stages_.finish());
  } catch (const std::exception& error) {
    log_(LogLevel::kError, std::string("the back-end could not finish: ") + error.what());
  }
  for (FrameEstimate& estimate : gaps_.rest()) end.finals.push_back(std::move(estimate));

  summary_.received = received_.load();
  summary_.dropped = newest_.overwritten() + passed_over_.load();
  const auto bound = static_cast<std::int64_t>(params_.frames_in_flight);
  const auto mark = [&](std::string name, std::size_t high_water) {
    summary_.queues.push_back({std::move(name), static_cast<std::int64_t>(high_water), bound});
  };
  mark("input>admit", input_.highWater());
  for (std::size_t edge = 0; edge < kEdges; ++edge)
    mark(kEdgeNames[edge], static_cast<std::size_t>(gauges_[edge].highWater()));
  mark("publish>output", results_.highWater());
  end.summary = summary_;
  return end;
}

// ---- The interface
// -----------------------------------------------------------------------------------------------------------

Pipeline::Pipeline(const PipelineParams& params, Stages stages, LogCallback log)
    : impl_(std::make_unique<Impl>(requireValid(params), std::move(stages), std::move(log))) {}
Pipeline::~Pipeline() = default;

bool Pipeline::push(StereoFrame frame) { return impl_->push(std::move(frame)); }
void Pipeline::passOver(const FrameHeader& frame) { impl_->passOver(frame); }
void Pipeline::close() { impl_->close(); }
std::optional<PipelineResult> Pipeline::next() { return impl_->next(); }
std::optional<PipelineResult> Pipeline::poll() { return impl_->poll(); }
PipelineEnd Pipeline::finish() { return impl_->finish(); }

}  // namespace motorcade
