#include "frontend/tracking/region_flow.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

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

constexpr double kLongest_s = 0.6;       // that is looked back: about a step of a walk
constexpr int kLeastSeen = 3;            // frames, with the newest
constexpr double kLeastNcc = 0.5;        // of a match that is believed
constexpr double kLeastSigma_px = 0.15;  // of a body that bends and swings its arms
constexpr int kAround_px = 3;            // of what is predicted by a known velocity, and of a disparity
constexpr int kMost_px = 24;             // that somebody moves between two frames

}  // namespace

std::optional<RegionFlow::Seen> RegionFlow::operator()(const InstanceRegion& region, double disparity_px,
                                                       const SceneMotion& scene, const SE3& T_world_cam) const {
  const Pixels pixels = pixelsOf(region, *scene.features->frame->inputs.instances);
  const RegionTemplate now(scene.features->left.levels.front(), pixels.middle_px, pixels.offsets_px);
  const auto seen = observe(now, pixels, *scene.features, {{pixels.middle_px.x(), pixels.middle_px.y(), disparity_px}});
  if (!seen) return std::nullopt;
  const Eigen::Vector3d p_cam = camera_.triangulate(seen->uvd_px.cast<double>());
  std::vector<PointObservation> observations{*seen};
  std::vector<const LookBack::PastScene*> scenes;
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  double last_s = 0;
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
    if (!then) continue;
    observations.push_back(*then);
    scenes.push_back(&past);
    last_s = dt_s;
    velocity_mps = (T_then_now.inverse() * camera_.triangulate(then->uvd_px.cast<double>()) - p_cam) / dt_s;
  }
  if (std::ssize(observations) < kLeastSeen) return std::nullopt;
  const auto flow = fit(observations, scenes, scene, T_world_cam);
  return flow ? std::optional<Seen>({*flow, -last_s}) : std::nullopt;
}

/// Pixels of a region with a margin: clothes may be smooth, and what tells most is where they end.
RegionFlow::Pixels RegionFlow::pixelsOf(const InstanceRegion& region, const InstanceLabels& labels) {
  constexpr int kMargin_px = 2;
  constexpr int kMost = 200;  // pixels, evenly spread
  const Box upper = upperPart(region.box);
  const int left = static_cast<int>(upper.left_px) - kMargin_px, right = static_cast<int>(upper.right_px) + kMargin_px,
            top = static_cast<int>(upper.top_px) - kMargin_px, bottom = static_cast<int>(upper.bottom_px);
  const int step = std::max(1, static_cast<int>(std::sqrt((right - left + 1) * (bottom - top + 1) / kMost)));
  const auto is = [&](int u, int v) { return labels.at(u, v) == region.label; };
  Pixels pixels;
  for (int v = top; v <= bottom; v += step)
    for (int u = left; u <= right; u += step)
      if (is(u, v) || is(u - kMargin_px, v) || is(u + kMargin_px, v) || is(u, v + kMargin_px))
        pixels.offsets_px.emplace_back(u, v);
  for (const Eigen::Vector2f& p : pixels.offsets_px)
    pixels.middle_px += p.cast<double>() / static_cast<double>(pixels.offsets_px.size());
  for (Eigen::Vector2f& p : pixels.offsets_px) p -= pixels.middle_px.cast<float>();
  return pixels;
}

/// Looks for the region in the left image, unless it is known there, and from there in the right one.
std::optional<PointObservation> RegionFlow::observe(const RegionTemplate& now, const Pixels& pixels,
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
