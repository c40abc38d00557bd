#include "frontend/matching/point_follower.hpp"

#include <cmath>

#include "core/elementary.hpp"
#include "frontend/image/image_pyramid.hpp"

namespace motorcade {
namespace {

/// Parameters at the coarse level, where an alignment only has to be near enough for the next level.
constexpr PatchParams kCoarse{.max_step_px = 0.1, .min_ncc = 0.6};
constexpr PatchParams kFine;

}  // namespace

std::optional<PatchTemplate> PointFollower::patchAt(const FlowObservation& point, int level) const {
  return makeTemplate(from_.levels[level], toLevel(point.u_px, level), toLevel(point.v_px, level), kPatchWindow_px,
                      PatchDeformation::kScale);
}

std::optional<CoarseFit> PointFollower::fit(const FlowObservation& point, const std::optional<PatchTemplate>& patch,
                                            const Shift& guess, int level) const {
  if (!patch) return CoarseFit{guess, 1};
  const float u = toLevel(point.u_px, level), v = toLevel(point.v_px, level), scale = static_cast<float>(1 << level);
  const Eigen::Vector2f guess_px(u + guess.du_px / scale, v + guess.dv_px / scale);
  const auto aligned = alignPatch(*patch, to_.levels[level], guess_px, kCoarse);
  if (!aligned) return std::nullopt;
  return CoarseFit{{(aligned->u_px - u) * scale, (aligned->v_px - v) * scale}, aligned->ncc};
}

std::optional<AlignedPatch> PointFollower::follow(const FlowObservation& point, const Shift& guess, int level) const {
  const auto start = fit(point, patchAt(point, level), guess, level);
  return start ? refine(point, start->shift, level - 1) : std::nullopt;
}

std::optional<AlignedPatch> PointFollower::refine(const FlowObservation& point, const Shift& guess, int level) const {
  const Eigen::Vector2f point_px(point.u_px, point.v_px), shift_px(guess.du_px, guess.dv_px);
  const auto forward = alignPatch(from_, point_px, to_, point_px + shift_px, level, kFine);
  if (!forward) return std::nullopt;
  const auto back = alignPatch(to_, {forward->u_px, forward->v_px}, from_, point_px, 0, kFine);
  if (!back || hypotenuse(back->u_px - point.u_px, back->v_px - point.v_px) > max_round_trip_px_) return std::nullopt;
  return forward;
}

}  // namespace motorcade
