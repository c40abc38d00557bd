#pragma once

#include <map>
#include <memory>
#include <vector>

#include "apps/pipeline/job.hpp"
#include "apps/pipeline/log_callback.hpp"
#include "apps/pipeline/stages.hpp"
#include "core/messages.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Each track's probability of existence when the shapes were last estimated.
using KnownExistence = std::map<TrackId, double>;

/// The pipeline's frame boundary: runs a stage on a job and notes its times. A stage that throws costs its frame, not
/// the run. The exception is logged and noted in the job, and a fallback replaces the stage's message. Each function
/// has the call rule of its stage, see `Stages`.
class StageRunner {
 public:
  StageRunner(Stages stages, LogCallback log);

  void prepare(Job& job);
  void matchStereo(Job& job);
  void trackFlow(Job& job);
  void segmentSceneFlow(Job& job);
  void trackObjects(Job& job);
  void optimize(Job& job);
  void shapeObjects(Job& job);
  /// The estimates that are still in the window; call it after the last frame.
  std::vector<FrameEstimate> finish();

 private:
  template <class Run, class Fallback>
  auto attempt(Job& job, Stage stage, const Run& run, const Fallback& fallback);

  Stages stages_;
  LogCallback log_;
  SceneMotionPtr last_motion_ = std::make_shared<SceneMotion>();  // of `segmentSceneFlow` alone
  KnownExistence existence_;                                      // of `shapeObjects` alone
};

}  // namespace motorcade
