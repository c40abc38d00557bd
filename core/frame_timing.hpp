#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

#include "core/messages.hpp"

/// Times at which each stage worked on a frame, for latency reports and traces.
namespace motorcade {

/// The pipeline's stages, in the order of the data.
enum class Stage {
  kPrepare,
  kStereoMatching,
  kOpticalFlow,
  kSceneFlowSegmentation,
  kTracking,
  kIncrementalOptimization,
  kObjectShapes
};
inline constexpr std::size_t kStageCount = static_cast<std::size_t>(Stage::kObjectShapes) + 1;
/// The stages' names as single words, for columns and keys of files.
inline constexpr auto kStageKeys =
    std::to_array<std::string_view>({"prepare", "stereo_matching", "optical_flow", "scene_flow_segmentation",
                                     "tracking", "incremental_optimization", "object_shapes"});
static_assert(kStageKeys.size() == kStageCount);

/// The name for readers: the key's words.
std::string nameOf(Stage stage);

/// The stages that a frame passes in turn, over one of the two branches: stereo matching or optical flow.
std::array<Stage, kStageCount - 1> pathOver(Stage branch);

inline double millisecondsBetween(SteadyTime from, SteadyTime to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

/// One stage's work on one frame; empty (start == end) where the stage did not run.
struct StageSpan {
  SteadyTime start, end;
  int worker = -1;    // slot of the arena that did the work
  double cpu_ms = 0;  // of that worker's thread alone; other threads' share of the stage's parallel loops is not in it
  bool ran() const { return start != end; }
  double duration_ms() const { return millisecondsBetween(start, end); }
};

/// One frame's way through the pipeline.
struct FrameTiming {
  FrameHead head;
  SteadyTime due;        // latency counts from here
  SteadyTime admitted;   // taken from the ring and put into the flow graph
  SteadyTime published;  // result ready for the reader
  double decode_ms = 0;  // done ahead, so not part of the latency; filled by who decodes
  SteadyTime decoded{};  // when that was done
  std::array<StageSpan, kStageCount> stages;
  int points = 0, inliers = 0, objects = 0;  // followed points, those of them that hold for the ego-motion, objects

  StageSpan& of(Stage stage) { return stages[static_cast<std::size_t>(stage)]; }
  const StageSpan& of(Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
  double latency_ms() const { return millisecondsBetween(due, published); }
  /// Wait from the moment the pair was due until it entered the flow graph.
  double entry_wait_ms() const { return admitted > due ? millisecondsBetween(due, admitted) : 0; }
  /// Moment at which all inputs of a stage were there.
  SteadyTime handedTo(Stage stage) const;
  /// Wait of the frame from then until the stage began; 0 where the stage did not run.
  double wait_ms(Stage stage) const;
  /// Wait from the end of the last stage until the reader could have the result.
  double publish_wait_ms() const {
    const StageSpan& last = of(Stage::kObjectShapes);
    return last.ran() ? millisecondsBetween(last.end, published) : 0;
  }
};

}  // namespace motorcade
