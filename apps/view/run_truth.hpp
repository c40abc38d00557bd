#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/measures/worst_frames.hpp"
#include "apps/view/shown_frame.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// A range of frames with some property, both ends included.
struct FrameSpan {
  std::int64_t from = 0, to = 0;
};
/// Spans of numbers that follow one another; `frames` in order.
std::vector<FrameSpan> spansOf(const std::vector<std::int64_t>& frames);

/// A label that is asked for in some frame, where it moves and is well enough in view.
struct AskedLabel {
  std::int64_t label = -1;
  std::string type{};
  std::vector<FrameSpan> spans{};
  std::vector<TrackId> tracks{};  // that followed it, the first one first; none where it was missed
};

/// Comparison of a run with its sequence's truth. Poses are in the run's world, which is its first frame.
struct RunTruth {
  std::string source{}, object_source{};  // the latter empty without labels
  double ate_m = 0;                       // root mean square of the positions below
  std::vector<ShownTruth> frames{};       // from the run's first frame on; the truth may end before the run
  std::vector<SE3> on_path{};             // the true path, moved onto the estimated one as a whole
  std::vector<AskedLabel> labels{};
  WorstFrames worst{};  // no two of a kind that are close to each other
};

/// Empty where the sequence has no truth of the run's first frame. Throws InputError naming the file that is damaged.
std::optional<RunTruth> readRunTruth(const RunFolder& run, const Sequence& sequence);

}  // namespace motorcade
