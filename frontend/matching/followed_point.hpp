#pragma once

#include <vector>

#include "core/image.hpp"
#include "frontend/image/patch_alignment.hpp"
#include "frontend/matching/corner_lookup.hpp"
#include "frontend/matching/neighbor_shifts.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// The patch to which a point is aligned.
struct Keyframe {
  Image image;
  float u_px = 0, v_px = 0;
  int frames = 0;   // number of frames since
  float scale = 1;  // by which the patch has grown since
};

/// A scene point that is followed from image to image.
struct FollowedPoint {
  FlowObservation observation;
  Shift shift;         // since the previous frame
  bool moved = false;  // found in this frame; otherwise `observation` is still that of the previous frame
  Keyframe keyframe;
  int descriptor = -1;  // with SIFT: index of its descriptor in this frame
};

/// Moves a point to a frame-to-frame position, corrected by alignment to its keyframe where that still fits.
void moveTo(FollowedPoint& point, const AlignedPatch& found, const Image& now);

/// Prefetches what `moveTo` reads of an old image into the cache.
void prefetchKeyframe(const FollowedPoint& point);

/// The shifts of all points that were found in this frame.
NeighborShifts shiftsOf(const std::vector<FollowedPoint>& points, const Image& image);

}  // namespace motorcade
