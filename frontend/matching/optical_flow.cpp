#include "frontend/matching/optical_flow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "frontend/features/sift_features.hpp"
#include "frontend/geometry/point_grid.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/matching/corner_lookup.hpp"
#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

using Params = OpticalFlowTracker::Params;

constexpr double kMaxGray = 255;

/// The patch that a track is held to.
struct Keyframe {
  Image image;
  float u_px = 0, v_px = 0;
  int frames = 0;   // since then
  float scale = 1;  // by which the patch has grown since then
};

struct Track {
  FlowObservation seen;
  Shift shift;         // since the frame before
  bool moved = false;  // in this frame; otherwise `seen` is still of the frame before
  Keyframe keyframe;
  int descriptor = -1;  // with SIFT: its point in this frame
};

/// One place in the image for one track.
class Occupancy {
 public:
  Occupancy(int width, int height, double distance_px)
      : distance_px_(static_cast<float>(distance_px)),
        columns_(cell(static_cast<float>(width)) + 3),
        rows_(cell(static_cast<float>(height)) + 3) {
    cells_.assign(static_cast<std::size_t>(columns_) * rows_, {-1e9F, -1e9F});
  }
  bool near(float u_px, float v_px) const {
    const int x = cell(u_px) + 1, y = cell(v_px) + 1;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Shift& p = cells_[index(x + dx, y + dy)];
        const float du = p.du_px - u_px, dv = p.dv_px - v_px;
        if (du * du + dv * dv < distance_px_ * distance_px_) return true;
      }
    }
    return false;
  }
  void take(float u_px, float v_px) { cells_[index(cell(u_px) + 1, cell(v_px) + 1)] = {u_px, v_px}; }

 private:
  int cell(float x_px) const { return static_cast<int>(x_px / distance_px_); }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * columns_ + x; }
  float distance_px_;
  int columns_, rows_;
  std::vector<Shift> cells_;  // the last position in each cell
};

/// Follows single points from one pyramid to the next.
class PointFollower {
 public:
  PointFollower(const ImagePyramid& from, const ImagePyramid& to, const Params& params)
      : from_(from), to_(to), params_(params), coarse_(params.patch) {
    coarse_.min_ncc = 0.6;
    coarse_.max_step_px = 0.1;
  }
  int coarsest() const { return static_cast<int>(from_.levels.size()) - 1; }

  /// How the point looks at a level of the pyramid.
  std::optional<PatchTemplate> patchAt(const FlowObservation& point, int level) const {
    return makeTemplate(from_.levels[level], toLevel(point.u_px, level), toLevel(point.v_px, level),
                        params_.patch.window_px, PatchDeformation::kScale);
  }

  /// Position in the new image, the better of all guesses at `level` (where the point looks like `patch`) refined to
  /// full size; checked backwards.
  std::optional<AlignedPatch> follow(const FlowObservation& point, const std::optional<PatchTemplate>& patch,
                                     std::span<const Shift> guesses, int level) const {
    const auto start = bestGuess(point, patch, guesses, level);
    if (!start) return std::nullopt;
    return refine(point, *start, level - 1);
  }

 private:
  std::optional<Shift> bestGuess(const FlowObservation& point, const std::optional<PatchTemplate>& patch,
                                 std::span<const Shift> guesses, int level) const {
    if (!patch) return guesses.front();
    const auto i = static_cast<std::size_t>(level);
    const float u = toLevel(point.u_px, level), v = toLevel(point.v_px, level), scale = static_cast<float>(1 << level);
    std::optional<Shift> best;
    float best_ncc = 0;
    for (const Shift& guess : guesses) {
      const auto aligned = alignPatch(*patch, to_.levels[i], u + guess.du_px / scale, v + guess.dv_px / scale, coarse_);
      if (!aligned || aligned->ncc <= best_ncc) continue;
      best_ncc = aligned->ncc;
      best = Shift{(aligned->u_px - u) * scale, (aligned->v_px - v) * scale};
    }
    return best;
  }

  std::optional<AlignedPatch> refine(const FlowObservation& point, const Shift& start, int level) const {
    const auto forward = alignPatch(from_, point.u_px, point.v_px, to_, point.u_px + start.du_px,
                                    point.v_px + start.dv_px, level, params_.patch);
    if (!forward) return std::nullopt;
    const auto back = alignPatch(to_, forward->u_px, forward->v_px, from_, point.u_px, point.v_px, 0, params_.patch);
    if (!back || std::hypot(back->u_px - point.u_px, back->v_px - point.v_px) > params_.max_round_trip_px)
      return std::nullopt;
    return forward;
  }

  const ImagePyramid& from_;
  const ImagePyramid& to_;
  const Params& params_;
  PatchParams coarse_;
};

float middle(float a, float b, float c) { return std::max(std::min(a, b), std::min(std::max(a, b), c)); }

/// The tracks that have moved, to look up how the neighbors of a point in the frame before moved.
class MovedTracks {
 public:
  MovedTracks(const std::vector<Track>& tracks, const Image& image)
      : grid_(collect(tracks), image.width(), image.height(), [](const Eigen::Vector2f& place) { return place; }) {}

  /// Median of the shifts of the three tracks that were nearest to a point.
  std::optional<Shift> shiftAround(const FlowObservation& point) const {
    if (moved_.size() < 3) return std::nullopt;
    const Eigen::Vector2f here(point.u_px, point.v_px);
    for (float reach_px = 1.5F * PointGrid::kCell_px;; reach_px *= 2) {
      const auto nearest = nearestThree(here, reach_px);
      if (nearest.back().first > reach_px * reach_px && reach_px < grid_.extent_px())
        continue;  // there may be nearer ones beyond the reach
      const Shift &a = shift(nearest[0].second), &b = shift(nearest[1].second), &c = shift(nearest[2].second);
      return Shift{middle(a.du_px, b.du_px, c.du_px), middle(a.dv_px, b.dv_px, c.dv_px)};
    }
  }

 private:
  using Neighbor =
      std::pair<float, int>;  // squared distance and number of the track; of equal distances the older track is nearer

  const std::vector<Eigen::Vector2f>& collect(const std::vector<Track>& tracks) {
    for (const Track& track : tracks) {
      if (!track.moved) continue;
      moved_.push_back(&track);
      places_.emplace_back(track.seen.u_px - track.shift.du_px, track.seen.v_px - track.shift.dv_px);
    }
    return places_;
  }
  std::array<Neighbor, 3> nearestThree(const Eigen::Vector2f& here, float reach_px) const {
    std::array<Neighbor, 3> nearest;
    nearest.fill({std::numeric_limits<float>::max(), -1});
    const Eigen::Vector2f reach(reach_px, reach_px);
    grid_.forEachNear(here - reach, here + reach, [&](int i) {
      const Neighbor candidate((places_[i] - here).squaredNorm(), i);
      if (candidate >= nearest.back()) return;
      nearest.back() = candidate;
      for (std::size_t k = nearest.size() - 1; k > 0 && nearest[k] < nearest[k - 1]; --k)
        std::swap(nearest[k], nearest[k - 1]);
    });
    return nearest;
  }
  const Shift& shift(int i) const { return moved_[i]->shift; }

  std::vector<const Track*> moved_;
  std::vector<Eigen::Vector2f> places_;  // in the frame before
  PointGrid grid_;
};

/// From rest to somewhat more than the neighbors' shift; anywhere when there are no neighbors.
ShiftBounds boundsAround(const std::optional<Shift>& neighbors, const Params& params) {
  const auto reach = static_cast<float>(params.max_flow_px);
  if (!neighbors) return {-reach, reach, -reach / 2, reach / 2};
  const float du = 1.3F * neighbors->du_px, dv = 1.3F * neighbors->dv_px,
              margin = static_cast<float>(params.young_margin_px);
  return {std::min(du, 0.0F) - margin, std::max(du, 0.0F) + margin, std::min(dv, 0.0F) - margin,
          std::max(dv, 0.0F) + margin};
}

/// The same for a point of a vehicle that crosses or overtakes: the road is level, hence only sideways.
ShiftBounds widened(const ShiftBounds& near, const Params& params) {
  const auto more = static_cast<float>(std::max(0.0, params.far_margin_px - params.young_margin_px));
  return {near.min_du_px - more, near.max_du_px + more, near.min_dv_px, near.max_dv_px};
}

bool sameSize(const Image& a, const Image& b) { return a.width() == b.width() && a.height() == b.height(); }

}  // namespace

struct OpticalFlowTracker::State {
  Params params;
  FeaturesPtr previous;  // empty at the start and after a rejected frame
  std::vector<Track> tracks;
  std::int64_t next_point = 0;

  void follow(const Features& now);
  void followMoving(const PointFollower& follower, const Image& now);
  void followYoung(const PointFollower& follower, const Features& now);
  void moveTo(Track& track, const AlignedPatch& found, const Image& now) const;
  void removeLost(const Image& now);
  void startTracks(const Features& now);
  void startTrack(const Features& now, int corner);
  void followDescriptors(const Features& now);
};

/// Takes over a frame-to-frame position, after alignment to the keyframe where that still looks alike.
void OpticalFlowTracker::State::moveTo(Track& track, const AlignedPatch& found, const Image& now) const {
  Keyframe& keyframe = track.keyframe;
  AlignedPatch position = found;
  ++keyframe.frames;
  keyframe.scale *= std::exp(found.log_growth);
  bool anchored = keyframe.frames == 1;  // found from the keyframe itself
  if (!anchored) {
    PatchParams held = params.patch;
    held.min_ncc = found.ncc - params.keyframe_max_ncc_loss;
    held.max_shift_px = params.keyframe_max_drift_px;
    const auto patch = makeTemplate(keyframe.image, keyframe.u_px, keyframe.v_px, held.window_px,
                                    PatchDeformation::kScale, keyframe.scale);
    const auto aligned = patch ? alignPatch(*patch, now, found.u_px, found.v_px, held) : std::nullopt;
    if (aligned) {
      position = *aligned;
      keyframe.scale *= std::exp(aligned->log_growth);
    }
    anchored = aligned.has_value();
  }
  track.shift = {position.u_px - track.seen.u_px, position.v_px - track.seen.v_px};
  track.seen = {track.seen.point, position.u_px, position.v_px, position.sigma_px, track.seen.age + 1, -1};
  track.moved = true;
  if (!anchored || keyframe.frames >= params.keyframe_frames) keyframe = {now, position.u_px, position.v_px, 0, 1};
}

/// Tracks that moved before: their own velocity is the guess.
void OpticalFlowTracker::State::followMoving(const PointFollower& follower, const Image& now) {
  const int level = std::min(params.moving_level, follower.coarsest());
  forEachItem(tracks.size(), [&](std::size_t i) {
    Track& track = tracks[i];
    if (track.seen.age < 2) return;
    const auto found = follower.follow(track.seen, follower.patchAt(track.seen, level), {&track.shift, 1}, level);
    if (found) moveTo(track, *found, now);
  });
}

/// New tracks, and those that their own velocity misled: guesses come from neighbors that moved and from corners that
/// look alike.
void OpticalFlowTracker::State::followYoung(const PointFollower& follower, const Features& now) {
  const MovedTracks moved(tracks, now.left.levels.front());
  std::vector<Track*> still;
  for (Track& track : tracks)
    if (!track.moved) still.push_back(&track);
  const CornerLookup corners(now);
  const int level = std::min(params.young_level, follower.coarsest());
  forEachItem(still.size(), [&](std::size_t i) {
    Track& track = *still[i];
    const auto neighbors = moved.shiftAround(track.seen);
    Guesses guesses;
    guesses.add(neighbors.value_or(Shift{}));
    const ShiftBounds near = boundsAround(neighbors, params);
    corners.addSimilar(previous->left, track.seen, near, kMaxGray, guesses);
    const auto patch = follower.patchAt(track.seen, level);
    auto found = follower.follow(track.seen, patch, guesses.all(), level);
    if (!found) {
      Guesses far;
      corners.addSimilar(previous->left, track.seen, widened(near, params), params.far_max_difference, far);
      if (far.count > 0) found = follower.follow(track.seen, patch, far.all(), level);
    }
    if (found) moveTo(track, *found, now.left.levels.front());
  });
}

/// Ends tracks that were not found, left the image or met an older track.
void OpticalFlowTracker::State::removeLost(const Image& now) {
  Occupancy occupancy(now.width(), now.height(), params.min_distance_px);
  const auto border = static_cast<float>(params.border_px);
  std::erase_if(tracks, [&](const Track& track) {
    const FlowObservation& p = track.seen;
    if (!track.moved || std::hypot(track.shift.du_px, track.shift.dv_px) > params.max_flow_px) return true;
    const bool inside = p.u_px >= border && p.v_px >= border &&
                        p.u_px <= static_cast<float>(now.width() - 1) - border &&
                        p.v_px <= static_cast<float>(now.height() - 1) - border;
    if (!inside || occupancy.near(p.u_px, p.v_px)) return true;
    occupancy.take(p.u_px, p.v_px);
    return false;
  });
}

void OpticalFlowTracker::State::follow(const Features& now) {
  for (Track& track : tracks) track.moved = false;
  const PointFollower follower(previous->left, now.left, params);
  const Image& image = now.left.levels.front();
  followMoving(follower, image);
  followYoung(follower, now);
  removeLost(image);
}

void OpticalFlowTracker::State::startTrack(const Features& now, int corner) {
  const Corner& at = now.corners[corner];
  Track& track = tracks.emplace_back();
  track.seen = {{next_point++}, at.u_px, at.v_px, static_cast<float>(params.patch.sigma_floor_px), 1, corner};
  track.keyframe = {now.left.levels.front(), at.u_px, at.v_px, 0, 1};
}

/// Starts tracks at the strongest free corners of the cells, those with the fewest tracks first.
void OpticalFlowTracker::State::startTracks(const Features& now) {
  const Image& image = now.left.levels.front();
  const int columns = (image.width() + params.cell_px - 1) / params.cell_px,
            rows = (image.height() + params.cell_px - 1) / params.cell_px;
  const auto cellOf = [&](float u_px, float v_px) {
    const int cell = static_cast<int>(v_px) / params.cell_px * columns + static_cast<int>(u_px) / params.cell_px;
    return static_cast<std::size_t>(cell);
  };
  std::vector<int> population(static_cast<std::size_t>(columns) * rows, 0);
  Occupancy occupancy(image.width(), image.height(), params.min_distance_px);
  for (const Track& track : tracks) {
    ++population[cellOf(track.seen.u_px, track.seen.v_px)];
    occupancy.take(track.seen.u_px, track.seen.v_px);
  }

  std::vector<int> by_score(now.corners.size());
  for (std::size_t i = 0; i < by_score.size(); ++i) by_score[i] = static_cast<int>(i);
  std::ranges::stable_sort(by_score, std::greater{}, [&](int i) { return now.corners[i].score; });
  for (int limit = 1; !by_score.empty(); ++limit) {
    std::erase_if(by_score, [&](int i) {
      if (static_cast<int>(tracks.size()) >= params.max_tracks) return true;
      const Corner& corner = now.corners[i];
      int& count = population[cellOf(corner.u_px, corner.v_px)];
      if (count >= limit) return false;
      if (occupancy.near(corner.u_px, corner.v_px)) return true;
      occupancy.take(corner.u_px, corner.v_px);
      ++count;
      startTrack(now, i);
      return true;
    });
  }
}

/// SIFT: tracks go on where descriptors match from frame to frame, and start at all other points.
void OpticalFlowTracker::State::followDescriptors(const Features& now) {
  std::vector<bool> taken(now.corners.size(), false);
  if (previous && !tracks.empty()) {
    const SiftSearchRegion region{-params.sift_max_flow_px, params.sift_max_flow_px, params.sift_max_flow_px};
    const auto match_of = matchSift(previous->corners, previous->descriptors, now.corners, now.descriptors, region,
                                    params.sift_max_ratio);
    std::erase_if(tracks, [&](const Track& track) { return match_of[track.descriptor] < 0; });
    for (Track& track : tracks) {
      track.descriptor = match_of[track.descriptor];
      taken[track.descriptor] = true;
      const Corner& at = now.corners[track.descriptor];
      track.seen = {track.seen.point,   at.u_px, at.v_px, static_cast<float>(params.sift_sigma_px),
                    track.seen.age + 1, -1};
    }
  }
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i]) continue;
    Track& track = tracks.emplace_back();
    track.descriptor = static_cast<int>(i);
    track.seen = {
        {next_point++},     now.corners[i].u_px, now.corners[i].v_px, static_cast<float>(params.sift_sigma_px), 1,
        static_cast<int>(i)};
  }
}

OpticalFlowTracker::OpticalFlowTracker(const Params& params) : state_(std::make_unique<State>()) {
  if (params.patch.window_px % 2 == 0 || params.patch.window_px > kMaxPatchWindow_px)
    throw std::invalid_argument("optical flow: patch.window_px must be odd and at most " +
                                std::to_string(kMaxPatchWindow_px));
  if (params.cell_px < 1 || params.min_distance_px <= 0)
    throw std::invalid_argument("optical flow: cell_px and min_distance_px must be positive");
  state_->params = requireValid(params);
}
OpticalFlowTracker::OpticalFlowTracker(OpticalFlowTracker&&) noexcept = default;
OpticalFlowTracker& OpticalFlowTracker::operator=(OpticalFlowTracker&&) noexcept = default;
OpticalFlowTracker::~OpticalFlowTracker() = default;

OpticalFlowPtr OpticalFlowTracker::operator()(const FeaturesPtr& features) {
  State& state = *state_;
  const bool rejected = features->frame->rejected();
  if (rejected || (state.previous && !sameSize(state.previous->left.levels.front(), features->left.levels.front()))) {
    state.tracks.clear();
    state.previous.reset();
  }
  if (!rejected && !features->descriptors.empty()) {
    state.followDescriptors(*features);
  } else if (!rejected) {
    if (state.previous) state.follow(*features);
    state.startTracks(*features);
  }
  if (!rejected) state.previous = features;

  OpticalFlow flow{.features = features, .observations = {}};
  flow.observations.reserve(state.tracks.size());
  for (const Track& track : state.tracks) flow.observations.push_back(track.seen);
  return std::make_shared<const OpticalFlow>(std::move(flow));
}

std::vector<Parameter> parametersOf(OpticalFlowTracker::Params& params) {
  return {
      numberParameter("max_tracks", params.max_tracks, {100, 20000}, "more points are more exact, fewer are faster"),
      numberParameter("max_flow_px", params.max_flow_px, {20, 1000}, "higher follows faster motion in the image"),
      numberParameter("max_round_trip_px", params.max_round_trip_px, {0.1, 5},
                      "higher keeps more points in noisy images, lower keeps better ones")};
}

}  // namespace motorcade
