#pragma once

#include <memory>
#include <vector>

#include "core/parameters.hpp"
#include "frontend/image/patch_alignment.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Follows scene points through the left images. Each point is aligned from frame to frame, coarse to fine and both
/// ways, then against its keyframe's patch (birth or last re-anchoring), which stops the random walk. New tracks start
/// at corners where tracks are few. Features with descriptors (SIFT) are followed by those instead. Call in frame
/// order. A rejected frame gives no tracks; those of the last good frame are then dropped, as they are when the image
/// size changes.
class OpticalFlowTracker {
 public:
  struct Params {
    int max_tracks = 2000;
    int cell_px = 48;
    double min_distance_px = 5;  // between tracks
    double max_round_trip_px = 0.5;
    double max_flow_px = 250;
    int border_px = 6;
    int keyframe_frames = 6;  // a track is anchored again after this many
    double keyframe_max_ncc_loss =
        0.2;  // or when it looks less like its keyframe than like the frame before, by more than this
    double keyframe_max_drift_px = 1;  // between the frame-to-frame position and the keyframe's
    int moving_level = 2;              // pyramid level at which a track with known velocity starts
    int young_level = 1;               // and one without
    double young_margin_px = 20;       // how far a new track may move otherwise than its neighbors
    double far_margin_px = 150;      // and sideways, when nothing like it is that near: vehicles that cross or overtake
    double far_max_difference = 30;  // mean difference of gray values to a corner that far
    PatchParams patch;
    double sift_max_flow_px = 150;
    double sift_max_ratio = 0.85;
    double sift_sigma_px = 0.4;
  };
  explicit OpticalFlowTracker(const Params& params);
  OpticalFlowTracker(OpticalFlowTracker&&) noexcept;
  OpticalFlowTracker& operator=(OpticalFlowTracker&&) noexcept;
  ~OpticalFlowTracker();

  OpticalFlowPtr operator()(const FeaturesPtr& features);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::vector<Parameter> parametersOf(OpticalFlowTracker::Params& params);

}  // namespace motorcade
