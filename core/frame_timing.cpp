#include "core/frame_timing.hpp"

#include <algorithm>

namespace motorcade {

SteadyTime FrameTiming::handedTo(Stage stage) const {
  switch (stage) {
    case Stage::kPrepare:
      return admitted;
    case Stage::kStereoMatching:
    case Stage::kOpticalFlow:
      return of(Stage::kPrepare).end;
    case Stage::kSceneFlowSegmentation:
      return std::max(of(Stage::kStereoMatching).end, of(Stage::kOpticalFlow).end);
    case Stage::kTracking:
      return of(Stage::kSceneFlowSegmentation).end;
    case Stage::kIncrementalOptimization:
      return of(Stage::kTracking).end;
    case Stage::kObjectShapes:
      return of(Stage::kIncrementalOptimization).end;
  }
  return admitted;
}

double FrameTiming::wait_ms(Stage stage) const {
  return of(stage).ran() ? millisecondsBetween(handedTo(stage), of(stage).start) : 0;
}

}  // namespace motorcade
