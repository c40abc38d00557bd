#include "frontend/matching/young_point_search.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace motorcade {
namespace {

// The pyramid level at which an alignment starts: guesses from corners are exact to a pixel, and need little reach.
constexpr int kLevel = 1;

// Bounds of the shift.
constexpr float kNeighborFactor = 1.3F;  // times the shift of the neighbors
constexpr float kNearMargin_px = 20;     // more than that in any direction
constexpr float kFarMargin_px = 150;     // more than that sideways, for a second try

// Greatest mean difference in gray levels to a corner.
constexpr double kMaxNearDifference = 255;  // none: the alignment decides
constexpr double kMaxFarDifference = 30;    // many corners are far, and most of them are wrong

/// Bounds from rest to somewhat more than the shift of the neighbors; anywhere when there are no neighbors.
ShiftBounds boundsAround(const std::optional<Shift>& neighbors, double max_flow_px) {
  const auto reach = static_cast<float>(max_flow_px);
  if (!neighbors) return {-reach, reach, -reach / 2, reach / 2};
  const float du = kNeighborFactor * neighbors->du_px, dv = kNeighborFactor * neighbors->dv_px;
  return {std::min(du, 0.0F) - kNearMargin_px, std::max(du, 0.0F) + kNearMargin_px, std::min(dv, 0.0F) - kNearMargin_px,
          std::max(dv, 0.0F) + kNearMargin_px};
}

/// Wider bounds for a point of a vehicle that crosses or overtakes. They grow sideways only, as the road is level.
ShiftBounds widened(const ShiftBounds& near) {
  constexpr float kMore_px = kFarMargin_px - kNearMargin_px;
  return {near.min_du_px - kMore_px, near.max_du_px + kMore_px, near.min_dv_px, near.max_dv_px};
}

bool same(const Shift& a, const Shift& b) { return a.du_px == b.du_px && a.dv_px == b.dv_px; }

/// Tries guesses of one point at the coarse level, none of them twice.
class CoarseTrials {
 public:
  CoarseTrials(const PointFollower& follower, const FlowObservation& point, int level)
      : follower_(follower), point_(point), level_(level), patch_(follower.patchAt(point, level)) {}

  std::optional<CoarseFit> at(const Shift& guess) {
    for (const Trial& trial : std::span(trials_).first(count_))
      if (same(trial.guess, guess)) return trial.fit;
    return (trials_[count_++] = {guess, follower_.fit(point_, patch_, guess, level_)}).fit;
  }
  /// The best fit of several guesses, of equal ones the first.
  std::optional<CoarseFit> bestAt(const Guesses& guesses) {
    std::optional<CoarseFit> best;
    for (const Shift& guess : guesses.all())
      if (const auto fit = at(guess); fit && (!best || fit->ncc > best->ncc)) best = fit;
    return best;
  }

 private:
  struct Trial {
    Shift guess;
    std::optional<CoarseFit> fit;
  };
  const PointFollower& follower_;
  const FlowObservation& point_;
  int level_;
  std::optional<PatchTemplate> patch_;
  std::array<Trial, 5> trials_;  // the neighbors' shift, two near corners and two far ones
  std::size_t count_ = 0;
};

}  // namespace

YoungPointSearch::YoungPointSearch(const PointFollower& follower, const Features& before, const Features& now,
                                   NeighborShifts neighbors, double max_flow_px)
    : follower_(follower),
      before_(before.left),
      corners_(now),
      neighbors_(std::move(neighbors)),
      max_flow_px_(max_flow_px) {}

std::optional<AlignedPatch> YoungPointSearch::operator()(const FlowObservation& point) const {
  const int level = std::min(kLevel, follower_.coarsestLevel());
  const auto neighbors = neighbors_.medianAround({point.u_px, point.v_px});
  const ShiftBounds near = boundsAround(neighbors, max_flow_px_);
  CoarseTrials trials(follower_, point, level);
  const Signature look(before_, point.u_px, point.v_px);
  const Eigen::Vector2f point_px(point.u_px, point.v_px);
  Guesses near_guesses, far_guesses;
  near_guesses.add(neighbors.value_or(Shift{}));
  corners_.addSimilar(look, point_px, near, kMaxNearDifference, near_guesses);
  const auto best = trials.bestAt(near_guesses);
  if (best)
    if (auto found = follower_.refine(point, best->shift, level - 1)) return found;

  corners_.addSimilar(look, point_px, widened(near), kMaxFarDifference, far_guesses);
  const auto other = trials.bestAt(far_guesses);
  if (!other || (best && same(other->shift, best->shift))) return std::nullopt;
  return follower_.refine(point, other->shift, level - 1);
}

}  // namespace motorcade
