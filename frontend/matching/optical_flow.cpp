#include "frontend/matching/optical_flow.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "frontend/features/sift_features.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/matching/corner_lookup.hpp"
#include "frontend/matching/neighbor_shifts.hpp"
#include "frontend/matching/occupancy.hpp"
#include "frontend/matching/point_follower.hpp"
#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

using Params = OpticalFlowTracker::Params;

constexpr int kBorder_px = 6;  // of the image, where a patch would repeat the image's last pixels

// A point gets a new keyframe when one of these is exceeded.
constexpr int kKeyframeFrames = 6;           // since the keyframe
constexpr double kMaxKeyframeNccLoss = 0.2;  // how much less a point looks like its keyframe than like the last frame
constexpr double kMaxKeyframeDrift_px = 1;   // from the frame-to-frame position to that of the keyframe's patch

// Pyramid levels at which an alignment starts. Young points (new ones, and those that did not keep their velocity) get
// their guesses from corners, which are exact to a pixel, and need less reach.
constexpr int kMovingLevel = 2, kYoungLevel = 1;

// Bounds of the shift of a young point.
constexpr float kNeighborFactor = 1.3F;  // times the shift of its neighbors
constexpr float kNearMargin_px = 20;     // more than that in any direction
constexpr float kFarMargin_px = 150;     // more than that sideways, for a second try

// Greatest mean difference in gray levels from a young point to a corner.
constexpr double kMaxNearDifference = 255;  // none: the alignment decides
constexpr double kMaxFarDifference = 30;    // many corners are far, and most of them are wrong

constexpr double kSiftMaxFlow_px = 150, kSiftMaxRatio = 0.85;  // as `matchSift` takes them

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

/// The shifts of all points that were found in this frame.
NeighborShifts shiftsOf(const std::vector<FollowedPoint>& points, const Image& image) {
  std::vector<MovedPoint> moved;
  for (const FollowedPoint& point : points) {
    if (!point.moved) continue;
    const FlowObservation& now = point.observation;
    moved.push_back({{now.u_px - point.shift.du_px, now.v_px - point.shift.dv_px}, point.shift});
  }
  return {std::move(moved), image.width(), image.height()};
}

/// From rest to somewhat more than the shift of the neighbors; anywhere when there are no neighbors.
ShiftBounds boundsAround(const std::optional<Shift>& neighbors, const Params& params) {
  const auto reach = static_cast<float>(params.max_flow_px);
  if (!neighbors) return {-reach, reach, -reach / 2, reach / 2};
  const float du = kNeighborFactor * neighbors->du_px, dv = kNeighborFactor * neighbors->dv_px;
  return {std::min(du, 0.0F) - kNearMargin_px, std::max(du, 0.0F) + kNearMargin_px, std::min(dv, 0.0F) - kNearMargin_px,
          std::max(dv, 0.0F) + kNearMargin_px};
}

/// Wider bounds for a point of a vehicle that crosses or overtakes. The road is level, so that it moves sideways.
ShiftBounds widened(const ShiftBounds& near) {
  constexpr float kMore_px = kFarMargin_px - kNearMargin_px;
  return {near.min_du_px - kMore_px, near.max_du_px + kMore_px, near.min_dv_px, near.max_dv_px};
}

/// The position near a frame-to-frame position at which the keyframe's patch, grown to its present scale, fits best.
std::optional<AlignedPatch> alignToKeyframe(const Keyframe& keyframe, const AlignedPatch& found, const Image& now) {
  PatchParams params;
  params.min_ncc = found.ncc - kMaxKeyframeNccLoss;
  params.max_shift_px = kMaxKeyframeDrift_px;
  const auto patch = makeTemplate(keyframe.image, keyframe.u_px, keyframe.v_px, kPatchWindow_px,
                                  PatchDeformation::kScale, keyframe.scale);
  return patch ? alignPatch(*patch, now, {found.u_px, found.v_px}, params) : std::nullopt;
}

/// Moves a point to a frame-to-frame position, corrected by alignment to its keyframe where that still fits.
void moveTo(FollowedPoint& point, const AlignedPatch& found, const Image& now) {
  Keyframe& keyframe = point.keyframe;
  AlignedPatch position = found;
  ++keyframe.frames;
  keyframe.scale *= std::exp(found.log_growth);
  bool anchored = keyframe.frames == 1;  // then the keyframe's own patch was aligned
  if (!anchored) {
    const auto aligned = alignToKeyframe(keyframe, found, now);
    if (aligned) {
      position = *aligned;
      keyframe.scale *= std::exp(aligned->log_growth);
    }
    anchored = aligned.has_value();
  }
  FlowObservation& seen = point.observation;
  point.shift = {position.u_px - seen.u_px, position.v_px - seen.v_px};
  seen = {seen.point, position.u_px, position.v_px, position.sigma_px, seen.age + 1, -1};
  point.moved = true;
  if (!anchored || keyframe.frames >= kKeyframeFrames) keyframe = {now, position.u_px, position.v_px, 0, 1};
}

/// Indices of the corners, the strongest first.
std::vector<int> strongestFirst(const std::vector<Corner>& corners) {
  std::vector<int> order(corners.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater{}, [&](int i) { return corners[i].score; });
  return order;
}

bool sameSize(const Image& a, const Image& b) { return a.width() == b.width() && a.height() == b.height(); }

}  // namespace

struct OpticalFlowTracker::State {
  Params params;
  FeaturesPtr previous;               // empty at the start and after a rejected frame
  std::vector<FollowedPoint> points;  // ordered by their ids
  std::int64_t next_id = 0;

  void follow(const Features& now);
  void followMoving(const PointFollower& follower, const Image& now);
  void followYoung(const PointFollower& follower, const Features& now);
  std::optional<AlignedPatch> searchYoung(const FlowObservation& point, const std::optional<Shift>& neighbors,
                                          const CornerLookup& corners, const PointFollower& follower) const;
  void removeLost(const Image& now);
  void startPoints(const Features& now);
  FollowedPoint& startPoint(const Features& now, int corner, double sigma_px);
  void followDescriptors(const Features& now);
};

/// Follows points that moved before. Their last shift is the guess.
void OpticalFlowTracker::State::followMoving(const PointFollower& follower, const Image& now) {
  const int level = std::min(kMovingLevel, follower.coarsestLevel());
  forEachItem(points.size(), [&](std::size_t i) {
    FollowedPoint& point = points[i];
    const FlowObservation& before = point.observation;
    if (before.age < 2) return;
    const auto found = follower.follow(before, follower.patchAt(before, level), {&point.shift, 1}, level);
    if (found) moveTo(point, *found, now);
  });
}

/// Follows the points that `followMoving` leaves: new ones, and those that did not keep their velocity.
void OpticalFlowTracker::State::followYoung(const PointFollower& follower, const Features& now) {
  const Image& image = now.left.levels.front();
  const NeighborShifts moved = shiftsOf(points, image);
  const CornerLookup corners(now);
  std::vector<FollowedPoint*> still;
  for (FollowedPoint& point : points)
    if (!point.moved) still.push_back(&point);
  forEachItem(still.size(), [&](std::size_t i) {
    const FlowObservation& before = still[i]->observation;
    const auto found = searchYoung(before, moved.medianAround({before.u_px, before.v_px}), corners, follower);
    if (found) moveTo(*still[i], *found, image);
  });
}

/// Follows a point by guesses from its neighbors and from corners that look like it, first near ones, then far ones.
std::optional<AlignedPatch> OpticalFlowTracker::State::searchYoung(const FlowObservation& point,
                                                                   const std::optional<Shift>& neighbors,
                                                                   const CornerLookup& corners,
                                                                   const PointFollower& follower) const {
  const int level = std::min(kYoungLevel, follower.coarsestLevel());
  const ShiftBounds near = boundsAround(neighbors, params);
  Guesses near_guesses, far_guesses;
  near_guesses.add(neighbors.value_or(Shift{}));
  corners.addSimilar(previous->left, point, near, kMaxNearDifference, near_guesses);
  const auto patch = follower.patchAt(point, level);
  if (auto found = follower.follow(point, patch, near_guesses.all(), level)) return found;
  corners.addSimilar(previous->left, point, widened(near), kMaxFarDifference, far_guesses);
  if (far_guesses.count == 0) return std::nullopt;
  return follower.follow(point, patch, far_guesses.all(), level);
}

/// Ends points that were not found, left the image or came close to an older point.
void OpticalFlowTracker::State::removeLost(const Image& now) {
  Occupancy occupancy(now.width(), now.height(), kMinDistance_px);
  constexpr float kBorder = kBorder_px;
  const float last_u = static_cast<float>(now.width() - 1) - kBorder,
              last_v = static_cast<float>(now.height() - 1) - kBorder;
  std::erase_if(points, [&](const FollowedPoint& point) {
    const FlowObservation& p = point.observation;
    if (!point.moved || std::hypot(point.shift.du_px, point.shift.dv_px) > params.max_flow_px) return true;
    const bool inside = p.u_px >= kBorder && p.v_px >= kBorder && p.u_px <= last_u && p.v_px <= last_v;
    if (!inside || occupancy.near(p.u_px, p.v_px)) return true;
    occupancy.take(p.u_px, p.v_px);
    return false;
  });
}

void OpticalFlowTracker::State::follow(const Features& now) {
  for (FollowedPoint& point : points) point.moved = false;
  const PointFollower follower(previous->left, now.left, params.max_round_trip_px);
  const Image& image = now.left.levels.front();
  followMoving(follower, image);
  followYoung(follower, now);
  removeLost(image);
}

FollowedPoint& OpticalFlowTracker::State::startPoint(const Features& now, int corner, double sigma_px) {
  const Corner& at = now.corners[corner];
  FollowedPoint& point = points.emplace_back();
  point.observation = {{next_id++}, at.u_px, at.v_px, static_cast<float>(sigma_px), 1, corner};
  return point;
}

/// Starts points at the strongest free corners of the cells, those with the fewest points first.
void OpticalFlowTracker::State::startPoints(const Features& now) {
  const Image& image = now.left.levels.front();
  const int columns = (image.width() + kCell_px - 1) / kCell_px, rows = (image.height() + kCell_px - 1) / kCell_px;
  const auto cellOf = [&](const auto& at) {
    return static_cast<int>(at.v_px) / kCell_px * columns + static_cast<int>(at.u_px) / kCell_px;
  };
  std::vector<int> population(columns * rows, 0);
  Occupancy occupancy(image.width(), image.height(), kMinDistance_px);
  for (const FollowedPoint& point : points) {
    ++population[cellOf(point.observation)];
    occupancy.take(point.observation.u_px, point.observation.v_px);
  }

  std::vector<int> candidates = strongestFirst(now.corners);
  for (int limit = 1; !candidates.empty(); ++limit) {
    std::erase_if(candidates, [&](int i) {
      if (static_cast<int>(points.size()) >= params.max_tracks) return true;
      const Corner& corner = now.corners[i];
      int& count = population[cellOf(corner)];
      if (count >= limit) return false;
      if (occupancy.near(corner.u_px, corner.v_px)) return true;
      occupancy.take(corner.u_px, corner.v_px);
      ++count;
      startPoint(now, i, kPatchSigmaFloor_px).keyframe = {image, corner.u_px, corner.v_px, 0, 1};
      return true;
    });
  }
}

/// Follows SIFT points, whose descriptors match from frame to frame, and starts points at all others.
void OpticalFlowTracker::State::followDescriptors(const Features& now) {
  std::vector<bool> taken(now.corners.size(), false);
  if (previous && !points.empty()) {
    const SiftSearchRegion region{-kSiftMaxFlow_px, kSiftMaxFlow_px, kSiftMaxFlow_px};
    const auto match_of =
        matchSift(previous->corners, previous->descriptors, now.corners, now.descriptors, region, kSiftMaxRatio);
    std::erase_if(points, [&](const FollowedPoint& point) { return match_of[point.descriptor] < 0; });
    for (FollowedPoint& point : points) {
      point.descriptor = match_of[point.descriptor];
      taken[point.descriptor] = true;
      const Corner& at = now.corners[point.descriptor];
      FlowObservation& seen = point.observation;
      seen = {seen.point, at.u_px, at.v_px, static_cast<float>(kSiftSigma_px), seen.age + 1, -1};
    }
  }
  for (int i = 0; i < static_cast<int>(taken.size()); ++i)
    if (!taken[i]) startPoint(now, i, kSiftSigma_px).descriptor = i;
}

OpticalFlowTracker::OpticalFlowTracker(const Params& params) : state_(std::make_unique<State>()) {
  state_->params = requireValid(params);
}
OpticalFlowTracker::OpticalFlowTracker(OpticalFlowTracker&&) noexcept = default;
OpticalFlowTracker& OpticalFlowTracker::operator=(OpticalFlowTracker&&) noexcept = default;
OpticalFlowTracker::~OpticalFlowTracker() = default;

OpticalFlowPtr OpticalFlowTracker::operator()(const FeaturesPtr& features) {
  State& state = *state_;
  const bool rejected = features->frame->rejected();
  if (rejected || (state.previous && !sameSize(state.previous->left.levels.front(), features->left.levels.front()))) {
    state.points.clear();
    state.previous.reset();
  }
  if (!rejected && !features->descriptors.empty()) {
    state.followDescriptors(*features);
  } else if (!rejected) {
    if (state.previous) state.follow(*features);
    state.startPoints(*features);
  }
  if (!rejected) state.previous = features;

  OpticalFlow flow{.features = features, .observations = {}};
  flow.observations.reserve(state.points.size());
  for (const FollowedPoint& point : state.points) flow.observations.push_back(point.observation);
  return std::make_shared<const OpticalFlow>(std::move(flow));
}

std::vector<Parameter> parametersOf(OpticalFlowTracker::Params& params) {
  return {
      numberParameter("max_tracks", params.max_tracks, {150, 20000}, "more points are more exact, fewer are faster"),
      numberParameter("max_flow_px", params.max_flow_px, {20, 1000}, "higher follows faster motion in the image"),
      numberParameter("max_round_trip_px", params.max_round_trip_px, {0.1, 5},
                      "higher keeps more points in noisy images, lower keeps better ones")};
}

}  // namespace motorcade
