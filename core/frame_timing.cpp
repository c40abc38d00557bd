#include "core/frame_timing.hpp"

#include <algorithm>

namespace motorcade {

std::string nameOf(Stage stage) {
  std::string name(kStageKeys[static_cast<std::size_t>(stage)]);
  std::ranges::replace(name, '_', ' ');
  return name;
}

std::array<Stage, kStageCount - 1> pathOver(Stage branch) {
  const Stage other = branch == Stage::kOpticalFlow ? Stage::kStereoMatching : Stage::kOpticalFlow;
  std::array<Stage, kStageCount - 1> path{};
  std::size_t length = 0;
  for (std::size_t i = 0; i < kStageCount; ++i)
    if (const auto stage = static_cast<Stage>(i); stage != other) path[length++] = stage;
  return path;
}

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
