#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "apps/pipeline/job.hpp"
#include "apps/pipeline/pipeline_result.hpp"

namespace motorcade {

class Entrance;
class Publisher;
class StageRunner;

/// The stages as a flow graph with workers of its own: jobs go in one by one and are published in the same order.
class FlowGraph {
 public:
  /// What its nodes call. They must outlive it.
  struct Work {
    StageRunner& stages;
    Publisher& publisher;  // closed when the last job is out
    Entrance& entrance;    // passed by each job that leaves scene flow segmentation
  };
  FlowGraph(int threads, const Work& work);
  /// Waits for the jobs in flight; `close` must have been called.
  ~FlowGraph();

  /// One thread: puts a job in; never refused.
  void put(Job& job);
  /// The same thread: no further job comes.
  void close();
  /// After `close`: waits until all jobs are out.
  void join();

  /// After `join`: how many jobs waited on each edge.
  std::vector<QueueMark> queues(std::int64_t bound) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace motorcade
