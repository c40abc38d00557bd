#include "apps/pipeline/flow_graph.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <future>
#include <thread>
#include <tuple>
#include <utility>

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>

#include "apps/pipeline/entrance.hpp"
#include "apps/pipeline/publisher.hpp"
#include "apps/pipeline/stage_runner.hpp"
#include "apps/pipeline/worker_team.hpp"
#include "core/thread_placement.hpp"

namespace motorcade {

/// Counts the frames that wait on one edge of the flow graph. Safe to use from several threads.
class EdgeMeter {
 public:
  void enter() {
    const auto now = waiting_.fetch_add(1, std::memory_order_relaxed) + 1;
    auto seen = high_water_.load(std::memory_order_relaxed);
    while (seen < now && !high_water_.compare_exchange_weak(seen, now, std::memory_order_relaxed)) {
    }
  }
  void leave() { waiting_.fetch_sub(1, std::memory_order_relaxed); }
  std::int64_t waiting() const { return waiting_.load(std::memory_order_relaxed); }
  std::int64_t highWater() const { return high_water_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::int64_t> waiting_{0}, high_water_{0};
};

namespace {

namespace flow = oneapi::tbb::flow;

using Node = flow::function_node<Job*, Job*>;
using InOrder = flow::sequencer_node<Job*>;
using JobPair = std::tuple<Job*, Job*>;  // twice the same job, from the two branches

/// The edges on which frames may wait.
enum Edge : std::size_t {
  kToPrepare,
  kToStereo,
  kToFlow,
  kStereoToSegmentation,
  kFlowToSegmentation,
  kToTracking,
  kToOptimization,
  kToShapes,
  kToPublish,
  kEdges
};
constexpr auto kEdgeNames = std::to_array<const char*>(
    {"admit>prepare", "prepare>stereo_matching", "prepare>optical_flow", "stereo_matching>scene_flow_segmentation",
     "optical_flow>scene_flow_segmentation", "scene_flow_segmentation>tracking", "tracking>incremental_optimization",
     "incremental_optimization>object_shapes", "object_shapes>publish"});
static_assert(kEdgeNames.size() == kEdges);

/// Declared after the nodes, so that none of them ends while a task may use it, also when the wiring lacks memory.
class Drained {
 public:
  explicit Drained(flow::graph& graph) : graph_(graph) {}
  ~Drained() {
    try {
      graph_.wait_for_all();
    } catch (...) {  // the exception that is under way, or one after it
    }
  }
  Drained(const Drained&) = delete;
  Drained& operator=(const Drained&) = delete;

 private:
  flow::graph& graph_;
};

constexpr auto kSequence = [](const Job* job) { return job->sequence; };
constexpr auto kSequenceOfPair = [](const JobPair& pair) { return std::get<0>(pair)->sequence; };

}  // namespace

class FlowGraph::Impl {
 public:
  Impl(const PipelineParams& params, Work work);
  ~Impl() { close(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void put(Job& job);
  void close() { team_.close(); }
  void join();
  void fail(const std::exception_ptr& reason);
  void abandon() { abandoned_ = true; }
  bool failed() { return failed_ || abandoned_ || context_.is_group_execution_cancelled(); }
  std::vector<QueueMark> queues(std::int64_t bound) const;
  std::vector<QueueDepth> depths(std::int64_t bound) const;

 private:
  void run(std::promise<void>& wired);
  void wireAndRun(std::promise<void>& wired);
  void await(flow::graph& graph, std::promise<void>& wired);
  template <class Act>
  void unlessGivenUp(const Act& act);
  auto stage(std::vector<Edge> in, void (StageRunner::*work)(Job&), std::vector<Edge> out);
  void publish(Job& job);

  Work work_;
  std::array<EdgeMeter, kEdges> meters_;
  int workers_;
  oneapi::tbb::task_arena arena_;
  WorkerTeam team_;
  /// Context of the graph, canceled when the library itself lacked memory for a task. Waiting for the graph does not
  /// reset it, as the next frame may come meanwhile.
  oneapi::tbb::task_group_context context_{oneapi::tbb::task_group_context::isolated,
                                           oneapi::tbb::task_group_context::concurrent_wait};
  std::atomic<bool> failed_ = false, abandoned_ = false;
  std::exception_ptr failure_;
  flow::receiver<Job*>* first_node_ = nullptr;  // on the stack of `run`, like all nodes; null until all are wired
  std::jthread thread_;
};

FlowGraph::Impl::Impl(const PipelineParams& params, Work work)
    : work_(std::move(work)),
      workers_(std::min(params.threads, oneapi::tbb::info::default_concurrency())),
      arena_(workers_, static_cast<unsigned>(workers_)),
      team_(arena_, workers_, params.placement) {
  std::promise<void> promise;
  auto wired = promise.get_future();
  thread_ = std::jthread([this, &promise, &params] {
    const PlacedThread placed(params.placement);
    run(promise);
  });
  wired.get();
}

/// No exception may leave the thread. The constructor rethrows those from before the graph is wired.
void FlowGraph::Impl::run(std::promise<void>& wired) {
  try {
    arena_.execute([this, &wired] { wireAndRun(wired); });
  } catch (...) {
    if (first_node_ == nullptr)
      wired.set_exception(std::current_exception());
    else
      fail(std::current_exception());
  }
}

void FlowGraph::Impl::fail(const std::exception_ptr& reason) {
  if (failed_.exchange(true)) return;
  failure_ = reason;
  work_.stop();
}

void FlowGraph::Impl::join() {
  thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

/// Calls `act` unless the work was given up. An exception ends the graph's work: jobs still pass through the nodes, but
/// no stage runs.
template <class Act>
void FlowGraph::Impl::unlessGivenUp(const Act& act) {
  if (failed_ || abandoned_) return;
  try {
    act();
  } catch (...) {
    fail(std::current_exception());
  }
}

/// Body of a node: takes the job off its incoming edges, works, and puts it on its outgoing edges.
auto FlowGraph::Impl::stage(std::vector<Edge> in, void (StageRunner::*work)(Job&), std::vector<Edge> out) {
  return [this, in = std::move(in), work, out = std::move(out)](Job* job) {
    team_.occupy();
    for (const Edge edge : in) meters_[edge].leave();
    unlessGivenUp([this, job, work] { (work_.stages.*work)(*job); });
    for (const Edge edge : out) meters_[edge].enter();
    return job;
  };
}

void FlowGraph::Impl::publish(Job& job) {
  meters_[kToPublish].leave();
  unlessGivenUp([this, &job] { work_.publisher.publish(job); });
  team_.finish();
}

/// Wires the graph: stateless stages `unlimited`, stages with memory `serial` behind a sequencer. (A serial node may
/// start its next message before it has handed on the last one.) Stays in the graph until it is closed and all jobs are
/// out.
void FlowGraph::Impl::wireAndRun(std::promise<void>& wired) {
  flow::graph graph(context_);
  Node prepare(graph, flow::unlimited, stage({kToPrepare}, &StageRunner::prepare, {kToStereo, kToFlow}));
  Node stereo_matching(graph, flow::unlimited, stage({kToStereo}, &StageRunner::matchStereo, {kStereoToSegmentation}));
  InOrder flow_order(graph, kSequence);
  Node optical_flow(graph, flow::serial, stage({kToFlow}, &StageRunner::trackFlow, {kFlowToSegmentation}));
  flow::join_node<JobPair, flow::key_matching<std::size_t>> both(graph, kSequence, kSequence);
  flow::sequencer_node<JobPair> segmentation_order(graph, kSequenceOfPair);
  const auto segment =
      stage({kStereoToSegmentation, kFlowToSegmentation}, &StageRunner::segmentSceneFlow, {kToTracking});
  flow::function_node<JobPair, Job*> scene_flow_segmentation(graph, flow::serial, [this, segment](const JobPair& pair) {
    Job* const job = segment(std::get<0>(pair));
    work_.entrance.pass();
    team_.reachTail();
    return job;
  });
  InOrder tracking_order(graph, kSequence);
  Node tracking(graph, flow::serial, stage({kToTracking}, &StageRunner::trackObjects, {kToOptimization}));
  InOrder optimization_order(graph, kSequence);
  Node incremental_optimization(graph, flow::serial, stage({kToOptimization}, &StageRunner::optimize, {kToShapes}));
  InOrder shapes_order(graph, kSequence);
  Node object_shapes(graph, flow::serial, stage({kToShapes}, &StageRunner::shapeObjects, {kToPublish}));
  InOrder publish_order(graph, kSequence);
  flow::function_node<Job*, flow::continue_msg> publish(graph, flow::serial, [this](Job* job) { this->publish(*job); });

  const Drained drained(graph);
  flow::make_edge(prepare, stereo_matching);
  flow::make_edge(prepare, flow_order);
  flow::make_edge(flow_order, optical_flow);
  flow::make_edge(stereo_matching, flow::input_port<0>(both));
  flow::make_edge(optical_flow, flow::input_port<1>(both));
  flow::make_edge(both, segmentation_order);
  flow::make_edge(segmentation_order, scene_flow_segmentation);
  flow::make_edge(scene_flow_segmentation, tracking_order);
  flow::make_edge(tracking_order, tracking);
  flow::make_edge(tracking, optimization_order);
  flow::make_edge(optimization_order, incremental_optimization);
  flow::make_edge(incremental_optimization, shapes_order);
  flow::make_edge(shapes_order, object_shapes);
  flow::make_edge(object_shapes, publish_order);
  flow::make_edge(publish_order, publish);

  first_node_ = &prepare;
  await(graph, wired);
}

void FlowGraph::Impl::await(flow::graph& graph, std::promise<void>& wired) {
  wired.set_value();
  try {
    team_.lead(graph);
  } catch (...) {
    fail(std::current_exception());
  }
  work_.publisher.close();
}

void FlowGraph::Impl::put(Job& job) {
  meters_[kToPrepare].enter();
  team_.expect();
  first_node_->try_put(&job);  // never refused: the node queues
  team_.call();
}

std::vector<QueueMark> FlowGraph::Impl::queues(std::int64_t bound) const {
  std::vector<QueueMark> marks;
  for (std::size_t edge = 0; edge < kEdges; ++edge)
    marks.push_back({kEdgeNames[edge], meters_[edge].highWater(), bound});
  return marks;
}

std::vector<QueueDepth> FlowGraph::Impl::depths(std::int64_t bound) const {
  std::vector<QueueDepth> depths;
  for (std::size_t edge = 0; edge < kEdges; ++edge)
    depths.push_back({kEdgeNames[edge], meters_[edge].waiting(), bound});
  return depths;
}

FlowGraph::FlowGraph(const PipelineParams& params, Work work)
    : impl_(std::make_unique<Impl>(params, std::move(work))) {}
FlowGraph::~FlowGraph() = default;

void FlowGraph::put(Job& job) { impl_->put(job); }
void FlowGraph::close() { impl_->close(); }
void FlowGraph::abandon() { impl_->abandon(); }
void FlowGraph::fail(const std::exception_ptr& reason) { impl_->fail(reason); }
bool FlowGraph::failed() { return impl_->failed(); }
void FlowGraph::join() { impl_->join(); }
std::vector<QueueDepth> FlowGraph::depths(std::int64_t bound) const { return impl_->depths(bound); }
std::vector<QueueMark> FlowGraph::queues(std::int64_t bound) const { return impl_->queues(bound); }

}  // namespace motorcade
