#include "frontend/tracking/region_flow.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/elementary.hpp"
#include "frontend/tracking/search_by_projection.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

/// Adds the columns `first` to `last` of a row.
void extend(Box& box, int first, int last, int row) {
  box.left_px = std::min<double>(box.left_px, first), box.right_px = std::max<double>(box.right_px, last);
  box.top_px = std::min<double>(box.top_px, row), box.bottom_px = std::max<double>(box.bottom_px, row);
}

}  // namespace

Box upperPart(const Box& region) {
  constexpr double kUpper = 0.6;
  return {region.left_px, region.top_px, region.right_px, region.top_px + kUpper * (region.bottom_px - region.top_px)};
}

std::vector<InstanceRegion> regionsOf(const InstanceLabels& labels) {
  constexpr Box kNowhere{1e9, 1e9, -1e9, -1e9};
  constexpr std::size_t kLabels = std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1;
  std::vector<Box> boxes(kLabels, kNowhere);
  for (int v = 0; v < labels.height(); ++v) {
    const std::uint16_t *const row = labels.row(v), *const end = row + labels.width();
    for (const std::uint16_t* from = row; from != end;) {
      const std::uint16_t label = *from;
      const std::uint16_t* const to = std::find_if(from, end, [label](std::uint16_t other) { return other != label; });
      extend(boxes[label], static_cast<int>(from - row), static_cast<int>(to - row) - 1, v);
      from = to;
    }
  }
  std::vector<InstanceRegion> regions;
  for (std::size_t label = 1; label < kLabels; ++label)
    if (boxes[label].left_px <= boxes[label].right_px)
      regions.push_back({static_cast<std::uint16_t>(label), boxes[label]});
  return regions;
}

namespace {

constexpr int kMostPixels = 200;         // of a region, evenly spread
constexpr double kLongest_s = 0.6;       // that is looked back: about a step of a walk
constexpr int kLeastSeen = 3;            // frames, with the newest
constexpr double kLeastNcc = 0.5;        // of a match that is believed
constexpr double kLeastSigma_px = 0.15;  // of a body that bends and swings its arms
constexpr int kAround_px = 3;            // of what is predicted by a known velocity, and of a disparity
constexpr int kMost_px = 24;             // that somebody moves between two frames

/// Pixels between two corners, both included, that belong to a region, evenly spread.
template <class Belongs>
RegionPixels regionPixels(const Eigen::Vector2i& first_px, const Eigen::Vector2i& last_px, const Belongs& belongs,
                          int most = kMostPixels) {
  RegionPixels region;
  const Eigen::Vector2i size_px = last_px - first_px + Eigen::Vector2i::Ones();
  region.step_px = std::max(1, static_cast<int>(std::sqrt(size_px.prod() / most)));
  for (int v = first_px.y(); v <= last_px.y(); v += region.step_px)
    for (int u = first_px.x(); u <= last_px.x(); u += region.step_px)
      if (belongs(u, v)) region.offsets_px.emplace_back(u, v);
  for (const Eigen::Vector2f& p : region.offsets_px)
    region.middle_px += p.cast<double>() / static_cast<double>(region.offsets_px.size());
  for (Eigen::Vector2f& p : region.offsets_px) p -= region.middle_px.cast<float>();
  return region;
}

/// Minus twice the logarithm of the likelihood of some pixels that correlate like this. Neighbors tell little more than
/// one of them: a window of seven by seven pixels counts once.
double misfit(const RegionPixels& region, double ncc) {
  constexpr double kWindow_px = 7;
  constexpr double kLeastUnexplained = 0.01;  // sampling between pixels leaves as much
  const double side = region.step_px / kWindow_px;
  return static_cast<double>(region.offsets_px.size()) * side * side * logarithm(1 + kLeastUnexplained - ncc);
}

}  // namespace

/// The margin shows where the body ends, which tells most: clothes may be smooth.
RegionPixels pixelsOf(const InstanceRegion& region, const InstanceLabels& labels) {
  constexpr int kMargin_px = 2;
  const Box upper = upperPart(region.box);
  const auto is = [&](int u, int v) { return labels.at(u, v) == region.label; };
  const auto belongs = [&](int u, int v) {
    return is(u, v) || is(u - kMargin_px, v) || is(u + kMargin_px, v) || is(u, v + kMargin_px);
  };
  return regionPixels({static_cast<int>(upper.left_px) - kMargin_px, static_cast<int>(upper.top_px) - kMargin_px},
                      {static_cast<int>(upper.right_px) + kMargin_px, static_cast<int>(upper.bottom_px)}, belongs);
}

RegionPixels pixelsIn(const Box& box, int most) {
  return regionPixels(
      {static_cast<int>(box.left_px), static_cast<int>(box.top_px)},
      {static_cast<int>(box.right_px), static_cast<int>(box.bottom_px)}, [](int, int) { return true; }, most);
}

RegionPixels pixelsAtDepth(const Box& box, double disparity_px, const SceneMotion& scene) {
  constexpr double kAround_px = 3;  // half of a patch's step
  const std::vector<ScenePoint> patches = samplePatches(*scene.features, box, disparity_px, scene.disparity_offset_px);
  const auto belongs = [&](int u, int v) {
    return std::ranges::any_of(patches, [&](const ScenePoint& patch) {
      return std::abs(patch.uvd_px.x() - u) <= kAround_px && std::abs(patch.uvd_px.y() - v) <= kAround_px;
    });
  };
  return regionPixels({static_cast<int>(box.left_px), static_cast<int>(box.top_px)},
                      {static_cast<int>(box.right_px), static_cast<int>(box.bottom_px)}, belongs);
}

std::optional<RegionFlow::Seen> RegionFlow::operator()(const RegionPixels& pixels, double disparity_px,
                                                       const SceneMotion& scene, const SE3& T_world_cam,
                                                       double least_found) const {
  const RegionTemplate now(scene.features->left.levels.front(), pixels.middle_px, pixels.offsets_px);
  const auto seen = observe(now, pixels, *scene.features, {{pixels.middle_px.x(), pixels.middle_px.y(), disparity_px}});
  if (!seen) return std::nullopt;
  const Eigen::Vector3d p_cam = camera_.triangulate(seen->uvd_px.cast<double>());
  std::vector<PointObservation> observations{*seen};
  std::vector<const LookBack::PastScene*> scenes;
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  double last_s = 0, not_static_chi2 = 0;
  const auto isLookedAt = [&](const LookBack::PastScene& past) {
    return secondsBetween(past.scene->head.stamp, scene.head.stamp) <= kLongest_s;
  };
  double may_miss = (1 - least_found) * static_cast<double>(std::ranges::count_if(past_.past(), isLookedAt));
  for (std::size_t k = past_.past().size(); k-- > 0;) {
    const LookBack::PastScene& past = past_.past()[k];
    const double dt_s = secondsBetween(scene.head.stamp, past.scene->head.stamp);
    if (!past.scene->features || -dt_s > kLongest_s) break;
    const SE3 T_then_now = past.T_world_cam.inverse() * T_world_cam;
    const auto uvd_px = camera_.project(T_then_now * (p_cam + dt_s * velocity_mps));
    if (!uvd_px) break;
    const double unsure_mps = scenes.empty() ? kFastestWalk_mps : 0.5 * kFastestWalk_mps;
    const double reach_px = unsure_mps * (last_s - dt_s) * uvd_px->z() / camera_.baseline_m;
    const int radius_px = std::min(kMost_px, kAround_px + static_cast<int>(reach_px));
    const auto then = observe(now, pixels, *past.scene->features,
                              {*uvd_px, uvd_px->z() / static_cast<double>(seen->uvd_px.z()), radius_px});
    if (!then && --may_miss < 0) return std::nullopt;
    if (!then) continue;
    const Eigen::Vector2d found_px = then->uvd_px.head<2>().cast<double>();
    const double ncc = now.ncc(past.scene->features->left.levels.front(), found_px, uvd_px->z() / seen->uvd_px.z());
    not_static_chi2 +=
        misfit(pixels, nccAtRest(now, seen->uvd_px.cast<double>(), past, T_then_now)) - misfit(pixels, ncc);
    observations.push_back(*then);
    scenes.push_back(&past);
    last_s = dt_s;
    velocity_mps = (T_then_now.inverse() * camera_.triangulate(then->uvd_px.cast<double>()) - p_cam) / dt_s;
  }
  if (std::ssize(observations) < kLeastSeen) return std::nullopt;
  const auto flow = fit(observations, scenes, scene, T_world_cam);
  return flow ? std::optional<Seen>({*flow, -last_s, not_static_chi2}) : std::nullopt;
}

bool RegionFlow::rests(const RegionPixels& region, double disparity_px, const SceneMotion& scene,
                       const SE3& T_world_cam) const {
  constexpr double kSame = 0.8;  // correlation
  if (past_.past().empty() || !past_.past().back().scene->features) return true;
  const LookBack::PastScene& past = past_.past().back();
  const RegionTemplate now(scene.features->left.levels.front(), region.middle_px, region.offsets_px);
  return nccAtRest(now, {region.middle_px.x(), region.middle_px.y(), disparity_px}, past,
                   past.T_world_cam.inverse() * T_world_cam, kSame) >= kSame;
}

/// The best correlation within the error of the disparity, or one that is high enough.
double RegionFlow::nccAtRest(const RegionTemplate& now, const Eigen::Vector3d& uvd_px, const LookBack::PastScene& past,
                             const SE3& T_then_now, double enough) const {
  double best = 0;
  for (const double error_px : {0.0, -0.5, 0.5, -1.0, 1.0}) {
    if (best >= enough) break;
    const Eigen::Vector3d here_px = uvd_px + Eigen::Vector3d(0, 0, error_px);
    if (const auto there_px = camera_.project(T_then_now * camera_.triangulate(here_px)))
      best = std::max(
          best, now.ncc(past.scene->features->left.levels.front(), there_px->head<2>(), there_px->z() / here_px.z()));
  }
  return best;
}

/// Looks for the region in the left image, unless it is known there, and from there in the right one.
std::optional<PointObservation> RegionFlow::observe(const RegionTemplate& now, const RegionPixels& pixels,
                                                    const Features& there, const Guess& guess) const {
  const Image &left = there.left.levels.front(), &right = there.right.levels.front();
  Eigen::Vector2d middle_px = guess.uvd_px.head<2>(), sigma_px = Eigen::Vector2d::Zero();
  if (guess.radius_px > 0) {
    const auto match = now.find(left, middle_px, guess.scale, {guess.radius_px, kAround_px});
    if (!match || match->ncc < kLeastNcc) return std::nullopt;
    middle_px = match->middle_px, sigma_px = match->sigma_px;
  }
  const RegionTemplate seen(left, middle_px, pixels.offsets_px, guess.scale);
  const auto match = seen.find(right, middle_px - Eigen::Vector2d(guess.uvd_px.z(), 0), guess.scale, {kAround_px, 0});
  if (!match || match->ncc < kLeastNcc) return std::nullopt;
  PointObservation observation;
  observation.uvd_px =
      Eigen::Vector3d(middle_px.x(), middle_px.y(), middle_px.x() - match->middle_px.x()).cast<float>();
  observation.sigma_px =
      Eigen::Vector3d(sigma_px.x(), sigma_px.y(), match->sigma_px.x()).cwiseMax(kLeastSigma_px).cast<float>();
  return observation;
}

std::optional<SceneFlow> RegionFlow::fit(const std::vector<PointObservation>& newest_first,
                                         const std::vector<const LookBack::PastScene*>& scenes,
                                         const SceneMotion& scene, const SE3& T_world_cam) const {
  PointTrack track;
  CameraTrail trail;
  SE3 T_world_before;
  const auto add = [&](Timestamp stamp, const SE3& T_world_now, PointObservation observation) {
    trail.add(stamp, T_world_before.inverse() * T_world_now);
    T_world_before = T_world_now;
    observation.step = trail.newest().step;
    track.add(observation);
  };
  for (std::size_t k = scenes.size(); k-- > 0;)
    add(scenes[k]->scene->head.stamp, scenes[k]->T_world_cam, newest_first[k + 1]);
  add(scene.head.stamp, T_world_cam, newest_first.front());
  return estimate_.fit(track, trail).moving;
}

}  // namespace motorcade
