#pragma once

#include <optional>
#include <span>

#include "frontend/image/patch_alignment.hpp"
#include "frontend/matching/corner_lookup.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Follows single points from one image to the next: from the best of several guesses at a coarse level of the pyramid
/// to full size, checked backwards. It refers to both pyramids.
class PointFollower {
 public:
  PointFollower(const ImagePyramid& from, const ImagePyramid& to, double max_round_trip_px)
      : from_(from), to_(to), max_round_trip_px_(max_round_trip_px) {}

  int coarsestLevel() const { return static_cast<int>(from_.levels.size()) - 1; }

  /// How a point looks at a level of the pyramid; empty without texture.
  std::optional<PatchTemplate> patchAt(const FlowObservation& point, int level) const;

  /// Aligns the point's patch of `level` at all guesses, of which there is at least one, and follows the best of them
  /// to full size. Without a patch the first guess counts. Empty when nothing fits, or when the way back does not lead
  /// to the point.
  std::optional<AlignedPatch> follow(const FlowObservation& point, const std::optional<PatchTemplate>& patch,
                                     std::span<const Shift> guesses, int level) const;

 private:
  std::optional<Shift> bestGuess(const FlowObservation& point, const std::optional<PatchTemplate>& patch,
                                 std::span<const Shift> guesses, int level) const;
  std::optional<AlignedPatch> refine(const FlowObservation& point, const Shift& start, int level) const;

  const ImagePyramid& from_;
  const ImagePyramid& to_;
  double max_round_trip_px_;
};

}  // namespace motorcade
