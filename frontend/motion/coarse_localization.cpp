#include "frontend/motion/coarse_localization.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/motion/window_correlation.hpp"
#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

constexpr int kMostPoints = 120;  // that vote
/// One in so many of them votes on all motions, the others only on those that it finds best: a range of motions grows
/// with the third power of the time, and three quarters of the votes on it would change little.
constexpr std::size_t kScoutShare = 4;
constexpr std::size_t kScouted = 8;   // turns at a distance that all points vote on
constexpr double kForwardStep_m = 1;  // a point 20 m ahead and 5 m aside moves by 9 px (f = 700 px) ...
constexpr double kTurnStep_px = 12;   // ... and any by so much: alignment bridges 16 px
constexpr double kMinDepth_m = 4;     // nearer points change too much
constexpr auto kMinSeenDepth_m = static_cast<float>(StereoCamera::kMinDepth_m);
constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
constexpr float kMinCorrelation =
    0.3F;  // mean over the points: of unlike places it is about as much, of the right one .4 to .8
constexpr std::size_t kMostCandidates = 3;  // peaks over the distance
constexpr float kMinVisibleShare = 0.3F;    // of the points, in the new image

/// Chooses points that are likely to be in view, those seen most often first, spread over the list.
std::vector<RestingPoint> chooseVoters(std::span<const RestingPoint> points, const SE3& T_now_then,
                                       const StereoCamera& camera) {
  std::vector<RestingPoint> voters;
  for (const RestingPoint& p : points) {
    const auto uvd = camera.project(T_now_then * p.p_cam);
    const bool far = uvd && (T_now_then * p.p_cam).z() > kMinDepth_m;
    if (far && camera.inLeftImage(uvd->x(), uvd->y())) voters.push_back(p);
  }
  std::ranges::stable_sort(voters, std::greater{}, &RestingPoint::observations);
  const std::size_t step = voters.size() >= 2 * kMostPoints ? 2 : 1;
  std::vector<RestingPoint> chosen;
  for (std::size_t i = 0; i < voters.size() && chosen.size() < kMostPoints; i += step) chosen.push_back(voters[i]);
  return chosen;
}

/// Points in the camera's frame of then, side by side.
struct Points {
  std::array<float, kMostPoints> x_m, y_m, z_m;
};
struct Places {
  std::array<float, kMostPoints> u_px, v_px;
};

/// A turn of the camera on a way of any length: T_now_then is linear in the way ahead, as the way bends by half of the
/// turn, whatever its length.
struct Turn {
  Eigen::Matrix3f R_now_then;
  Eigen::Vector3f t_now_then_m, per_forward;

  Turn(const Vector6d& twist_then_now, double yaw_rad, double pitch_rad) {
    Vector6d twist = twist_then_now;
    twist[3] += pitch_rad;
    twist[4] += yaw_rad;
    const SE3 T_now_then = SE3::exp(twist).inverse();
    twist.z() += 1;
    const SE3 farther = SE3::exp(twist).inverse();
    R_now_then = T_now_then.rotation().cast<float>();
    t_now_then_m = T_now_then.translation().cast<float>();
    per_forward = (farther.translation() - T_now_then.translation()).cast<float>();
  }
};

struct Candidate {
  std::size_t turn = 0;
  float correlation = -1;
};

/// Searches all turns at one distance: the patches' scales hardly depend on the turn.
class TurnSearch {
 public:
  TurnSearch(const std::vector<RestingPoint>& voters, const ImagePyramid& then, const ImagePyramid& now,
             const MotionRange& range, const StereoCamera& camera);

  Candidate best(float forward_m) const;
  SE3 motion(const Candidate& candidate, double forward_m) const;

 private:
  /// The points with a texture, and how they look from a distance.
  struct Voters {
    std::size_t scouts = 0, count = 0;  // the scouts are the first ones
    Points points;
    std::vector<WindowPattern> patterns;
  };
  Voters votersAt(float forward_m) const;
  Places project(const Voters& voters, std::size_t count, const Turn& turn, float forward_m) const;
  std::vector<Candidate> scout(const Voters& voters, float forward_m) const;
  float correlation(const Voters& voters, std::size_t count, const Turn& turn, float forward_m) const;

  const std::vector<RestingPoint>& voters_;
  const Image& then_;
  CorrelatedImage now_;
  int level_;
  Vector6d predicted_;
  float fx_px_, fy_px_, cx_px_, cy_px_;               // at that level
  std::vector<std::pair<double, double>> turns_rad_;  // yaw and pitch of the turns
  std::vector<Turn> turns_;
  std::size_t straight_ = 0;  // the turn that was predicted
};

TurnSearch::TurnSearch(const std::vector<RestingPoint>& voters, const ImagePyramid& then, const ImagePyramid& now,
                       const MotionRange& range, const StereoCamera& camera)
    : voters_(voters),
      then_(then.levels.back()),
      now_(now.levels.back()),
      level_(static_cast<int>(then.levels.size()) - 1),
      predicted_(range.T_then_now.log()),
      fx_px_(static_cast<float>(camera.fx_px) / static_cast<float>(1 << level_)),
      fy_px_(static_cast<float>(camera.fy_px) / static_cast<float>(1 << level_)),
      cx_px_(toLevel(static_cast<float>(camera.cx_px), level_)),
      cy_px_(toLevel(static_cast<float>(camera.cy_px), level_)) {
  const double step_rad = kTurnStep_px / camera.fx_px;
  const double view_rad = 2 * std::atan(0.5 * camera.width_px / camera.fx_px);  // beyond it nothing is left in view
  const int yaws = static_cast<int>(std::ceil(std::min(range.yaw_rad, view_rad) / step_rad)),
            pitches = static_cast<int>(std::ceil(range.pitch_rad / step_rad));
  for (int yaw = -yaws; yaw <= yaws; ++yaw) {
    for (int pitch = -pitches; pitch <= pitches; ++pitch) {
      if (yaw == 0 && pitch == 0) straight_ = turns_.size();
      turns_rad_.emplace_back(yaw * step_rad, pitch * step_rad);
      turns_.emplace_back(predicted_, yaw * step_rad, pitch * step_rad);
    }
  }
}

SE3 TurnSearch::motion(const Candidate& candidate, double forward_m) const {
  const auto [yaw_rad, pitch_rad] = turns_rad_[candidate.turn];
  Vector6d twist = predicted_;
  twist.z() += forward_m;
  twist[3] += pitch_rad;
  twist[4] += yaw_rad;
  return SE3::exp(twist);
}

/// The scouts are spread over the list.
TurnSearch::Voters TurnSearch::votersAt(float forward_m) const {
  const Turn& straight = turns_[straight_];
  Voters voters;
  voters.patterns.reserve(voters_.size());
  for (std::size_t first = 0; first < kScoutShare; ++first) {
    for (std::size_t i = first; i < voters_.size(); i += kScoutShare) {
      const RestingPoint& p = voters_[i];
      const Eigen::Vector3f p_cam = p.p_cam.cast<float>();
      const float depth_m =
          straight.R_now_then.row(2).dot(p_cam) + straight.t_now_then_m.z() + forward_m * straight.per_forward.z();
      if (depth_m < kMinDepth_m) continue;
      const auto u = static_cast<float>(p.uvd_px.x()), v = static_cast<float>(p.uvd_px.y());
      const auto pattern = WindowPattern::sample(then_, {toLevel(u, level_), toLevel(v, level_)}, p_cam.z() / depth_m);
      if (!pattern) continue;
      voters.points.x_m[voters.count] = p_cam.x();
      voters.points.y_m[voters.count] = p_cam.y();
      voters.points.z_m[voters.count++] = p_cam.z();
      voters.patterns.push_back(*pattern);
    }
    if (first == 0) voters.scouts = voters.count;
  }
  return voters;
}

/// Places of the first `count` points at the coarsest level; `kNowhere` for those behind the camera.
Places TurnSearch::project(const Voters& voters, std::size_t count, const Turn& turn, float forward_m) const {
  const Eigen::Matrix3f& R = turn.R_now_then;
  const Eigen::Vector3f t_m = turn.t_now_then_m + forward_m * turn.per_forward;
  const Points& p = voters.points;
  Places places;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = R(0, 0) * p.x_m[i] + R(0, 1) * p.y_m[i] + R(0, 2) * p.z_m[i] + t_m.x();
    const float y = R(1, 0) * p.x_m[i] + R(1, 1) * p.y_m[i] + R(1, 2) * p.z_m[i] + t_m.y();
    const float z = R(2, 0) * p.x_m[i] + R(2, 1) * p.y_m[i] + R(2, 2) * p.z_m[i] + t_m.z();
    const float per_z = z < kMinSeenDepth_m ? kNowhere : 1 / z;
    places.u_px[i] = fx_px_ * x * per_z + cx_px_;
    places.v_px[i] = fy_px_ * y * per_z + cy_px_;
  }
  return places;
}

/// The mean over the first `count` of the points, as far as they are in view; -1 where too few are.
float TurnSearch::correlation(const Voters& voters, std::size_t count, const Turn& turn, float forward_m) const {
  const Places places = project(voters, count, turn, forward_m);
  float sum = 0;
  int visible = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = now_.correlation(voters.patterns[i], {places.u_px[i], places.v_px[i]});
    if (!value) continue;
    ++visible;
    sum += std::max(*value, 0.0F);
  }
  const bool enough = visible > 0 && static_cast<float>(visible) >= kMinVisibleShare * static_cast<float>(count);
  return enough ? sum / static_cast<float>(visible) : -1;
}

/// The turns that the scouts find best.
std::vector<Candidate> TurnSearch::scout(const Voters& voters, float forward_m) const {
  std::vector<Candidate> candidates(turns_.size());
  for (std::size_t i = 0; i < turns_.size(); ++i)
    candidates[i] = {i, correlation(voters, voters.scouts, turns_[i], forward_m)};
  const std::size_t kept = std::min(candidates.size(), kScouted);
  std::ranges::partial_sort(
      candidates, candidates.begin() + static_cast<std::ptrdiff_t>(kept), [](const Candidate& a, const Candidate& b) {
        return a.correlation > b.correlation || (a.correlation == b.correlation && a.turn < b.turn);
      });
  candidates.resize(kept);
  return candidates;
}

Candidate TurnSearch::best(float forward_m) const {
  const Voters voters = votersAt(forward_m);
  Candidate best;
  for (const Candidate& scouted : scout(voters, forward_m)) {
    const float value = correlation(voters, voters.count, turns_[scouted.turn], forward_m);
    if (value > best.correlation) best = {scouted.turn, value};
  }
  return best;
}

}  // namespace

std::vector<SE3> localizeCoarsely(std::span<const RestingPoint> points, const ImagePyramid& then,
                                  const ImagePyramid& now, const MotionRange& range, const StereoCamera& camera) {
  const std::vector<RestingPoint> voters = chooseVoters(points, range.T_then_now.inverse(), camera);
  const TurnSearch search(voters, then, now, range, camera);
  const int steps = static_cast<int>(std::ceil(range.forward_m / kForwardStep_m));
  const auto forward_m = [&](std::size_t i) { return (static_cast<int>(i) - steps) * kForwardStep_m; };
  std::vector<Candidate> of_distance(static_cast<std::size_t>(2 * steps + 1));
  forEachItem(
      of_distance.size(), [&](std::size_t i) { of_distance[i] = search.best(static_cast<float>(forward_m(i))); }, 1);
  std::vector<std::size_t> peaks;
  for (std::size_t i = 0; i < of_distance.size(); ++i) {
    const float here = of_distance[i].correlation;
    const bool peak = (i == 0 || here >= of_distance[i - 1].correlation) &&
                      (i + 1 == of_distance.size() || here > of_distance[i + 1].correlation);
    if (peak && here > kMinCorrelation) peaks.push_back(i);
  }
  std::ranges::stable_sort(peaks, std::greater{}, [&](std::size_t i) { return of_distance[i].correlation; });
  if (peaks.size() > kMostCandidates) peaks.resize(kMostCandidates);
  std::vector<SE3> motions;
  for (const std::size_t i : peaks) motions.push_back(search.motion(of_distance[i], forward_m(i)));
  return motions;
}

}  // namespace motorcade
