#pragma once

#include <thread>

#include "apps/inject/fault_injector.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "apps/pipeline/pipeline_result.hpp"
#include "apps/run/camera_clock.hpp"
#include "apps/run/run_watch.hpp"
#include "apps/view/replay_gate.hpp"
#include "io/inputs/pair_source.hpp"

namespace motorcade {

/// Hands the pairs of a source to the pipeline on a thread of its own, then closes it. With a clock, each pair enters
/// when it is due; without, as soon as there is room.
class Feeder {
 public:
  /// Parts that may stand between source and pipeline; each may be absent.
  struct Between {
    CameraClock* clock = nullptr;     // started with the first pair
    FaultInjector* faults = nullptr;  // change the pairs on their way
    InputWatch* watch = nullptr;      // sees them as they enter, and may end the drive
    RunListeners listeners{};         // see those that entered
    ReplayGate* gate = nullptr;       // may hold the replay
  };
  /// Pairs that the source leaves out are passed over.
  Feeder(PairSource& source, Pipeline& pipeline, const Between& between);
  /// Closes the pipeline, too, so that the thread never waits for room in it.
  ~Feeder();

  /// Lets no further pair enter; from any thread.
  void stop();

 private:
  void feed(const std::stop_token& stopped);
  void passGate(const std::stop_token& stopped);
  bool enter(StereoFrame frame, const std::stop_token& stopped);
  bool push(StereoFrame frame);
  FaultInjector::Outlet pipelineAfterFaults(const std::stop_token& stopped);

  PairSource& source_;
  Pipeline& pipeline_;
  CameraClock* clock_;
  FaultInjector* faults_;
  InputWatch* watch_;
  RunListeners listeners_;
  ReplayGate* gate_;
  FrameId next_;  // after the last pair that entered
  std::jthread thread_;
};

}  // namespace motorcade
