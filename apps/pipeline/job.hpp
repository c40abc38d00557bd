#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <semaphore>
#include <string>
#include <vector>

#include "apps/pipeline/gap_filler.hpp"
#include "core/frame_timing.hpp"
#include "core/messages.hpp"
#include "core/spsc_ring.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// One frame on its way through the stages, with the messages made so far. Each field has one writer; the graph's edges
/// order writers before readers.
struct Job {
  std::size_t sequence = 0;          // without gaps, unlike the frame's id
  std::vector<MissedFrame> dropped;  // or refused, since the frame before
  std::int64_t dropped_unnamed = 0;  // more of them, of which nothing is known
  StereoFramePtr frame;
  FeaturesPtr features;
  StereoMatchesPtr matches;
  OpticalFlowPtr flow;
  SceneMotionPtr motion;
  FrameMeasurementsPtr measurements;
  EstimatesPtr estimates;
  FrameTiming timing;
  std::array<std::string, kStageCount> problems;  // exceptions of the stages

  std::string& problemOf(Stage stage) { return problems[static_cast<std::size_t>(stage)]; }
  /// `frame 12`, for messages.
  std::string name() const { return "frame " + std::to_string(timing.head.frame.value); }
  /// Releases the messages, with their images.
  void clear() {
    dropped.clear();
    frame.reset();
    features.reset();
    matches.reset();
    flow.reset();
    motion.reset();
    measurements.reset();
    estimates.reset();
  }
};

/// Jobs that are free: a frame needs one to enter the flow graph, so that no more are in flight than there are jobs.
/// One thread takes jobs, one gives them back.
class FreeJobs {
 public:
  explicit FreeJobs(std::size_t count) : jobs_(count), free_(count), count_(0) {
    for (Job& job : jobs_) giveBack(job);
  }

  /// Waits for a free job. Null once closed, or when `given_up`, which is asked now and then, says that none will come.
  template <class GivenUp>
  Job* take(const GivenUp& given_up) {
    constexpr std::chrono::milliseconds kPatience(100);
    while (!count_.try_acquire_for(kPatience))
      if (given_up()) return nullptr;
    return free_.closed() ? nullptr : free_.tryPop().value_or(nullptr);
  }
  void giveBack(Job& job) {
    if (free_.push(&job)) count_.release();
  }
  void close() {
    free_.close();
    count_.release();
  }

 private:
  std::vector<Job> jobs_;
  SpscRing<Job*> free_;
  std::counting_semaphore<> count_;  // of what is in the ring; unlike the ring's, its waits can have an end
};

}  // namespace motorcade
