#include "frontend/matching/followed_point.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "core/elementary.hpp"
#include "frontend/image/patch_alignment.hpp"

namespace motorcade {
namespace {

// A point gets a new keyframe when one of these is exceeded.
constexpr int kKeyframeFrames = 6;           // since the keyframe
constexpr double kMaxKeyframeNccLoss = 0.2;  // how much less a point looks like its keyframe than like the last frame
constexpr double kMaxKeyframeDrift_px = 1;   // from the frame-to-frame position to that of the keyframe's patch

/// Aligns the keyframe's patch, grown to its present scale, near the frame-to-frame position.
std::optional<AlignedPatch> alignToKeyframe(const Keyframe& keyframe, const AlignedPatch& found, const Image& now) {
  PatchParams params;
  params.min_ncc = found.ncc - kMaxKeyframeNccLoss;
  params.max_shift_px = kMaxKeyframeDrift_px;
  const auto patch = makeTemplate(keyframe.image, keyframe.u_px, keyframe.v_px, kPatchWindow_px,
                                  PatchDeformation::kScale, keyframe.scale);
  return patch ? alignPatch(*patch, now, {found.u_px, found.v_px}, params) : std::nullopt;
}

}  // namespace

void moveTo(FollowedPoint& point, const AlignedPatch& found, const Image& now) {
  Keyframe& keyframe = point.keyframe;
  AlignedPatch position = found;
  ++keyframe.frames;
  keyframe.scale *= exponential(found.log_growth);
  bool anchored = keyframe.frames == 1;  // then the keyframe's own patch was aligned
  if (!anchored) {
    const auto aligned = alignToKeyframe(keyframe, found, now);
    if (aligned) {
      position = *aligned;
      keyframe.scale *= exponential(aligned->log_growth);
    }
    anchored = aligned.has_value();
  }
  FlowObservation& seen = point.observation;
  point.shift = {position.u_px - seen.u_px, position.v_px - seen.v_px};
  seen = {seen.point, position.u_px, position.v_px, position.sigma_px, seen.age + 1, -1};
  point.moved = true;
  if (!anchored || keyframe.frames >= kKeyframeFrames) keyframe = {now, position.u_px, position.v_px, 0, 1};
}

void prefetchKeyframe(const FollowedPoint& point) {
  const Keyframe& keyframe = point.keyframe;
  if (keyframe.frames > 0) prefetchPatch(keyframe.image, keyframe.u_px, keyframe.v_px, kPatchWindow_px);
}

NeighborShifts shiftsOf(const std::vector<FollowedPoint>& points, const Image& image) {
  std::vector<MovedPoint> moved;
  for (const FollowedPoint& point : points) {
    if (!point.moved) continue;
    const FlowObservation& now = point.observation;
    moved.push_back({{now.u_px - point.shift.du_px, now.v_px - point.shift.dv_px}, point.shift});
  }
  return {std::move(moved), image.width(), image.height()};
}

}  // namespace motorcade
