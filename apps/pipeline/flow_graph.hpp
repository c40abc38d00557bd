#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <vector>

#include "apps/pipeline/job.hpp"
#include "apps/pipeline/pipeline_params.hpp"
#include "apps/pipeline/pipeline_result.hpp"

namespace motorcade {

class Entrance;
class Publisher;
class StageRunner;

/// The stages as a flow graph with workers of its own: jobs go in one by one and are published in the same order.
class FlowGraph {
 public:
  /// Objects that the nodes call. They must outlive the graph.
  struct Work {
    StageRunner& stages;
    Publisher& publisher;  // closed when the last job is out
    Entrance& entrance;    // passed by each job that leaves scene flow segmentation
    /// Called once, from any thread, when the graph cannot go on: jobs may have been lost.
    std::function<void()> stop;
  };
  FlowGraph(const PipelineParams& params, Work work);
  /// Waits for the jobs in flight.
  ~FlowGraph();

  /// One thread: puts a job in, which is never refused.
  void put(Job& job);
  /// The same thread: no further job comes.
  void close();
  /// Any thread: ends the work of the graph, for a reason that `join` throws.
  void fail(const std::exception_ptr& reason);
  /// Any thread: stops the work on jobs in flight and on further ones; they only come out.
  void abandon();
  /// True when the graph cannot or shall not go on; it has been closed or will be.
  bool failed();
  /// Waits, after `close`, until all jobs are out. Throws the exception that the graph failed with.
  void join();

  /// Any thread: the number of jobs that wait on each edge now.
  std::vector<QueueDepth> depths(std::int64_t bound) const;
  /// The most jobs that ever waited on each edge; valid after `join`.
  std::vector<QueueMark> queues(std::int64_t bound) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace motorcade
