#include "frontend/matching/optical_flow.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/elementary.hpp"
#include "frontend/features/sift_features.hpp"
#include "frontend/geometry/point_grid.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/matching/followed_point.hpp"
#include "frontend/matching/image_content.hpp"
#include "frontend/matching/image_jump.hpp"
#include "frontend/matching/occupancy.hpp"
#include "frontend/matching/point_follower.hpp"
#include "frontend/matching/young_point_search.hpp"
#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

using Params = OpticalFlowTracker::Params;

constexpr int kBorder_px = 6;  // of the image, where a patch would repeat the image's last pixels

constexpr int kMovingLevel = 2;  // of the pyramid, at which an alignment starts from a point's last shift

// An image in which few points are found is of no use (dark, blurred, hidden): the points wait for a better one, for a
// while. Clean drives find two thirds of them from frame to frame, poor images fewer; after n intervals an n-th is
// found.
constexpr double kMinFoundShare = 0.6;                    // of the share that is found usually
constexpr double kUsualShare = 0.75, kUsualMemory = 0.8;  // at first, and how much of it stays from frame to frame
constexpr double kMinSharpFoundShare = 0.4;               // where the image is sharp: the camera may have turned
constexpr int kFewToJudge = 30;                           // points: too few for a share
constexpr double kMinTextureShare = 0.4;  // of the texture in the image before: blurred by 9 px it is a fifth
constexpr double kSharpShare = 0.7;
constexpr int kMaxWaiting_frames = 3;    // then all points start anew
constexpr double kMaxWaiting_s = 0.5;    // beyond it points look different, and the scene flow stage finds them better
constexpr double kStanding_px = 0.5;     // points that moved by less since the last frame may rest
constexpr double kUnevenInterval = 1.5;  // times the interval before: frames are missing
constexpr double kSparse_s = 0.15;  // between frames: where a sharp one shows few of the points, the next one would too

constexpr double kSiftMaxFlow_px = 150, kSiftMaxFlowRatio = 0.85;  // as `matchSift` takes them

/// True when frames are missing in so many intervals.
bool isUneven(double intervals) { return intervals > kUnevenInterval || intervals < 1 / kUnevenInterval; }

/// Last shift of a point, scaled from its own interval to so many of them.
Shift shiftAfter(const FollowedPoint& point, double intervals) {
  if (!isUneven(intervals)) return point.shift;
  const auto factor = static_cast<float>(intervals);
  return {factor * point.shift.du_px, factor * point.shift.dv_px};
}

/// Indices of the corners, the strongest first.
std::vector<int> strongestFirst(const std::vector<Corner>& corners) {
  std::vector<int> order(corners.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater{}, [&](int i) { return corners[i].score; });
  return order;
}

/// Orders points by place: the pixels of one are then mostly in the cache from those before.
std::vector<int> byPlace(const std::vector<FollowedPoint>& points, const Image& image) {
  const auto position_px = [](const FollowedPoint& point) {
    return Eigen::Vector2f(point.observation.u_px, point.observation.v_px);
  };
  return PointGrid(points, image.width(), image.height(), position_px).byPlace();
}

bool sameSize(const Image& a, const Image& b) { return a.width() == b.width() && a.height() == b.height(); }

}  // namespace

struct OpticalFlowTracker::State {
  Params params;
  FeaturesPtr previous;               // in which the points were seen last, empty at the start
  std::vector<FollowedPoint> points;  // ordered by their ids
  double interval_s = 0;              // in which the points made their last shift
  int waiting_frames = 0;             // of no use, since `previous`
  double usual_share = kUsualShare;   // of the points, found from frame to frame
  std::int64_t next_id = 0;

  bool advance(const FeaturesPtr& features);
  double intervalsSince(const Features& now) const;
  bool mayWait(Timestamp now) const;
  bool follow(const Features& now);
  std::vector<std::optional<AlignedPatch>> findMoving(const PointFollower& follower, double intervals,
                                                      std::span<const int> order, const Shift& jump) const;
  std::optional<Shift> jumpTo(const Features& now, const PointFollower& follower, std::span<const int> order) const;
  bool isFrozen(const Features& now) const;
  bool isSparse(const Features& now) const;
  std::optional<double> shareOf(const std::vector<std::optional<AlignedPatch>>& found) const;
  double sharpness(const Features& now) const;
  bool isOfNoUse(const Features& now, const std::vector<std::optional<AlignedPatch>>& found, double intervals) const;
  void followYoung(const PointFollower& follower, const Features& now, std::span<const int> order);
  void removeLost(const Image& now);
  void startPoints(const Features& now);
  FollowedPoint& startPoint(const Features& now, int corner, double sigma_px);
  void followDescriptors(const Features& now);
};

/// Finds the points that moved before, with their last shift and a jump as the guess.
std::vector<std::optional<AlignedPatch>> OpticalFlowTracker::State::findMoving(const PointFollower& follower,
                                                                               double intervals,
                                                                               std::span<const int> order,
                                                                               const Shift& jump) const {
  const int level = std::min(kMovingLevel, follower.coarsestLevel());
  std::vector<std::optional<AlignedPatch>> found(points.size());
  forEachItem(order.size(), [&](std::size_t k) {
    const int i = order[k];
    const FlowObservation& before = points[i].observation;
    if (before.age < 2) return;
    const Shift last = shiftAfter(points[i], intervals);
    found[i] = follower.follow(before, {last.du_px + jump.du_px, last.dv_px + jump.dv_px}, level);
  });
  return found;
}

/// Share of the points that moved before; empty where they are too few.
std::optional<double> OpticalFlowTracker::State::shareOf(const std::vector<std::optional<AlignedPatch>>& found) const {
  const auto moving = std::ranges::count_if(points, [](const FollowedPoint& p) { return p.observation.age >= 2; });
  const auto seen = std::ranges::count_if(found, [](const auto& f) { return f.has_value(); });
  if (moving < kFewToJudge) return std::nullopt;
  return static_cast<double>(seen) / static_cast<double>(moving);
}

/// Texture of an image as a share of that in the image before.
double OpticalFlowTracker::State::sharpness(const Features& now) const {
  return textureOf(now) / std::max(textureOf(*previous), 1e-9);
}

/// Jump of a sharp image, in which few points may be found for that.
std::optional<Shift> OpticalFlowTracker::State::jumpTo(const Features& now, const PointFollower& follower,
                                                       std::span<const int> order) const {
  if (isUneven(intervalsSince(now)) || isFrozen(now) || sharpness(now) < kSharpShare) return std::nullopt;
  const Image& image = now.left.levels.front();
  const NeighborShifts none({}, image.width(), image.height());
  return imageJump(points, order, YoungPointSearch(follower, *previous, now, none, params.max_flow_px));
}

bool OpticalFlowTracker::State::isOfNoUse(const Features& now, const std::vector<std::optional<AlignedPatch>>& found,
                                          double intervals) const {
  const double texture = sharpness(now);
  if (isFrozen(now) || texture < kMinTextureShare) return true;
  const double min_share = (texture < kSharpShare ? kMinFoundShare : kMinSharpFoundShare) * usual_share /
                           (isUneven(intervals) ? std::max(intervals, 1.0) : 1.0);
  const auto share = shareOf(found);
  return share && *share < min_share;
}

/// Follows the remaining points: new ones, and those that did not keep their velocity.
void OpticalFlowTracker::State::followYoung(const PointFollower& follower, const Features& now,
                                            std::span<const int> order) {
  const Image& image = now.left.levels.front();
  const YoungPointSearch search(follower, *previous, now, shiftsOf(points, image), params.max_flow_px);
  std::vector<FollowedPoint*> still;
  for (const int i : order)
    if (!points[i].moved) still.push_back(&points[i]);
  forEachItem(still.size(), [&](std::size_t i) {
    const auto found = search(still[i]->observation);
    if (found) moveTo(*still[i], *found, image);
  });
}

/// Ends points that were not found, left the image or came close to an older point.
void OpticalFlowTracker::State::removeLost(const Image& now) {
  Occupancy occupancy(now.width(), now.height(), kMinDistance_px);
  constexpr float kBorder = kBorder_px;
  const float last_u = static_cast<float>(now.width() - 1) - kBorder,
              last_v = static_cast<float>(now.height() - 1) - kBorder;
  std::erase_if(points, [&](const FollowedPoint& point) {
    const FlowObservation& p = point.observation;
    if (!point.moved || hypotenuse(point.shift.du_px, point.shift.dv_px) > params.max_flow_px) return true;
    const bool inside = p.u_px >= kBorder && p.v_px >= kBorder && p.u_px <= last_u && p.v_px <= last_v;
    if (!inside || occupancy.near(p.u_px, p.v_px)) return true;
    occupancy.take(p.u_px, p.v_px);
    return false;
  });
}

/// True when the image repeats although the points moved until now: a camera that stands still does not repeat its
/// noise.
bool OpticalFlowTracker::State::isFrozen(const Features& now) const {
  if (!sameContent(now.left.levels.back(), previous->left.levels.back())) return false;
  const auto moved = std::ranges::count_if(
      points, [](const FollowedPoint& p) { return hypotenuse(p.shift.du_px, p.shift.dv_px) > kStanding_px; });
  return 2 * moved > std::ssize(points);
}

/// Follows the points. Returns false, with the points as they were, when the image is of no use.
bool OpticalFlowTracker::State::follow(const Features& now) {
  const PointFollower follower(previous->left, now.left, params.max_round_trip_px);
  const Image& image = now.left.levels.front();
  const double intervals = intervalsSince(now);
  const std::vector<int> order = byPlace(points, image);
  auto found = findMoving(follower, intervals, order, {});
  if (isOfNoUse(now, found, intervals)) {
    const auto jump = jumpTo(now, follower, order);
    if (jump) found = findMoving(follower, intervals, order, *jump);
    if (!jump || isOfNoUse(now, found, intervals)) return false;
  }
  if (const auto share = isUneven(intervals) ? std::nullopt : shareOf(found))
    usual_share = kUsualMemory * usual_share + (1 - kUsualMemory) * *share;
  interval_s = secondsBetween(previous->frame->head.stamp, now.frame->head.stamp);
  forEachItem(order.size(), [&](std::size_t k) {
    const int i = order[k];
    const std::size_t next = std::min(k + 1, order.size() - 1);
    if (found[order[next]]) prefetchKeyframe(points[order[next]]);
    points[i].moved = false;
    if (found[i]) moveTo(points[i], *found[i], image);
  });
  followYoung(follower, now, order);
  removeLost(image);
  return true;
}

/// Time since the points were seen last, in intervals of their last shift.
double OpticalFlowTracker::State::intervalsSince(const Features& now) const {
  return interval_s > 0 ? secondsBetween(previous->frame->head.stamp, now.frame->head.stamp) / interval_s : 1;
}

/// True when as much may have changed as over missing frames, however regular the frames are, and nothing is wrong with
/// the image.
bool OpticalFlowTracker::State::isSparse(const Features& now) const {
  return secondsBetween(previous->frame->head.stamp, now.frame->head.stamp) > kSparse_s && !isFrozen(now) &&
         sharpness(now) >= kSharpShare;
}

bool OpticalFlowTracker::State::mayWait(Timestamp now) const {
  return previous && waiting_frames < kMaxWaiting_frames &&
         secondsBetween(previous->frame->head.stamp, now) < kMaxWaiting_s;
}

/// Follows the points and starts new ones; false when the points wait for the next frame.
bool OpticalFlowTracker::State::advance(const FeaturesPtr& features) {
  const Features& now = *features;
  const bool followed = previous && follow(now);
  if (previous && !followed) {
    const bool looks_different = waiting_frames == 0 && (intervalsSince(now) > kUnevenInterval || isSparse(now));
    if (!looks_different && mayWait(now.frame->head.stamp)) return false;
    points.clear();
    interval_s = 0;
  }
  startPoints(now);
  return true;
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
        matchSift(previous->corners, previous->descriptors, now.corners, now.descriptors, region, kSiftMaxFlowRatio);
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
  const bool resized =
      !rejected && state.previous && !sameSize(state.previous->left.levels.front(), features->left.levels.front());
  if (resized || (rejected && !state.mayWait(features->frame->head.stamp))) {
    state.points.clear();
    state.previous.reset();
    state.interval_s = 0;
  }
  bool seen = !rejected;
  if (!rejected && !features->descriptors.empty())
    state.followDescriptors(*features);
  else if (!rejected)
    seen = state.advance(features);
  state.waiting_frames = seen ? 0 : state.waiting_frames + 1;
  if (seen) state.previous = features;

  OpticalFlow flow{.features = features, .observations = {}};
  if (!seen) return std::make_shared<const OpticalFlow>(std::move(flow));
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
