#pragma once

#include <optional>

#include "frontend/image/patch_alignment.hpp"
#include "frontend/matching/corner_lookup.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Fit of a patch at a coarse level.
struct CoarseFit {
  Shift shift;
  float ncc = 0;
};

/// Follows single points from one image to the next: from a guess at a coarse level of the pyramid to full size,
/// checked backwards. It refers to both pyramids.
class PointFollower {
 public:
  PointFollower(const ImagePyramid& from, const ImagePyramid& to, double max_round_trip_px)
      : from_(from), to_(to), max_round_trip_px_(max_round_trip_px) {}

  int coarsestLevel() const { return static_cast<int>(from_.levels.size()) - 1; }

  /// Appearance of a point at a level of the pyramid; empty without texture.
  std::optional<PatchTemplate> patchAt(const FlowObservation& point, int level) const;

  /// Fits the point's patch of `level` near a guess; without a patch the guess itself fits. Empty when it does not fit.
  std::optional<CoarseFit> fit(const FlowObservation& point, const std::optional<PatchTemplate>& patch,
                               const Shift& guess, int level) const;

  /// Follows the point from a guess to full size, with `level` the coarsest. Empty when it does not fit, or when the
  /// way back does not lead to the point.
  std::optional<AlignedPatch> refine(const FlowObservation& point, const Shift& guess, int level) const;

  /// Fits the point at `level`, then refines it.
  std::optional<AlignedPatch> follow(const FlowObservation& point, const Shift& guess, int level) const;

 private:
  const ImagePyramid& from_;
  const ImagePyramid& to_;
  double max_round_trip_px_;
};

}  // namespace motorcade
