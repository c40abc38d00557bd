#include "frontend/motion/coarse_localization.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

constexpr int kMostPoints = 120;  // that vote
constexpr int kPatch = 8;         // side of a patch, in pixels of the coarsest level
constexpr int kPatchPixels = kPatch * kPatch;
constexpr double kForwardStep_m = 1;  // a point 20 m ahead and 5 m aside moves by 9 px (f = 700 px) ...
constexpr double kTurnStep_px = 12;   // ... and any by so much: alignment bridges 16 px
constexpr double kMinDepth_m = 4;     // nearer points change too much
constexpr double kMinTexture = 16;    // norm of a patch, in gray levels: two levels at each pixel
constexpr double kMinCorrelation =
    0.3;  // mean over the points: of unlike places it is about as much, of the right one .4 to .8
constexpr std::size_t kMostCandidates = 3;  // peaks over the distance
constexpr double kMinVisibleShare = 0.3;    // of the points, in the new image

using Patch = std::array<float, kPatchPixels>;

/// Samples the nearest pixels around a place, enlarged by `scale`; false outside of the image.
bool sample(const Image& image, float x, float y, float scale, Patch& out) {
  const float step = 1 / scale, half = 0.5F * (kPatch - 1) * step;
  const float left = x - half + 0.5F, top = y - half + 0.5F;
  if (!(left >= 0 && top >= 0)) return false;
  if (left + 2 * half >= static_cast<float>(image.width()) || top + 2 * half >= static_cast<float>(image.height()))
    return false;
  std::array<int, kPatch> columns{};
  for (int i = 0; i < kPatch; ++i) columns[i] = static_cast<int>(left + static_cast<float>(i) * step);
  for (int j = 0, k = 0; j < kPatch; ++j) {
    const std::uint8_t* const row = image.row(static_cast<int>(top + static_cast<float>(j) * step));
    for (int i = 0; i < kPatch; ++i) out[k++] = row[columns[i]];
  }
  return true;
}

/// Subtracts the mean and divides by the norm; false without texture.
bool normalize(Patch& patch) {
  float sum = 0;
  for (const float v : patch) sum += v;
  const float mean = sum / kPatchPixels;
  float square = 0;
  for (float& v : patch) v -= mean, square += v * v;
  const float norm = std::sqrt(square);
  if (norm < kMinTexture) return false;
  for (float& v : patch) v /= norm;
  return true;
}

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

struct Candidate {
  SE3 T_then_now;
  double correlation = -1;
};

/// Searches all turns at one distance: the patches' scales hardly depend on the turn.
class TurnSearch {
 public:
  TurnSearch(const std::vector<RestingPoint>& voters, const ImagePyramid& then, const ImagePyramid& now,
             const StereoCamera& camera)
      : voters_(voters),
        then_(then.levels.back()),
        now_(now.levels.back()),
        level_(static_cast<int>(then.levels.size()) - 1),
        camera_(camera) {}

  Candidate best(const MotionRange& range, double forward_m) const;

 private:
  SE3 motion(const MotionRange& range, double forward_m, double yaw_rad, double pitch_rad) const;
  std::vector<std::optional<Patch>> patchesAt(const SE3& T_now_then) const;
  double correlation(const std::vector<std::optional<Patch>>& patches, const SE3& T_now_then) const;

  const std::vector<RestingPoint>& voters_;
  const Image &then_, &now_;
  int level_;
  const StereoCamera& camera_;
};

/// Motion with the way bent by half of the turn.
SE3 TurnSearch::motion(const MotionRange& range, double forward_m, double yaw_rad, double pitch_rad) const {
  Vector6d more = Vector6d::Zero();
  more.z() = forward_m;
  more[3] = pitch_rad;
  more[4] = yaw_rad;
  const Vector6d twist = range.T_then_now.log() + more;
  return SE3::exp(twist);
}

std::vector<std::optional<Patch>> TurnSearch::patchesAt(const SE3& T_now_then) const {
  std::vector<std::optional<Patch>> patches(voters_.size());
  for (std::size_t i = 0; i < voters_.size(); ++i) {
    const RestingPoint& p = voters_[i];
    const double depth_m = (T_now_then * p.p_cam).z();
    if (depth_m < kMinDepth_m) continue;
    Patch patch;
    const auto u = static_cast<float>(p.uvd_px.x()), v = static_cast<float>(p.uvd_px.y());
    if (sample(then_, toLevel(u, level_), toLevel(v, level_), static_cast<float>(p.p_cam.z() / depth_m), patch) &&
        normalize(patch))
      patches[i] = patch;
  }
  return patches;
}

double TurnSearch::correlation(const std::vector<std::optional<Patch>>& patches, const SE3& T_now_then) const {
  double sum = 0;
  int visible = 0, textured = 0;
  for (std::size_t i = 0; i < voters_.size(); ++i) {
    if (!patches[i]) continue;
    ++textured;
    const auto uvd = camera_.project(T_now_then * voters_[i].p_cam);
    Patch here;
    if (!uvd || !sample(now_, toLevel(static_cast<float>(uvd->x()), level_),
                        toLevel(static_cast<float>(uvd->y()), level_), 1, here))
      continue;
    ++visible;
    if (!normalize(here)) continue;
    float dot = 0;
    for (int k = 0; k < kPatchPixels; ++k) dot += (*patches[i])[k] * here[k];
    sum += std::max(dot, 0.0F);
  }
  const bool enough = visible > 0 && visible >= kMinVisibleShare * textured;
  return enough ? sum / visible : -1;
}

Candidate TurnSearch::best(const MotionRange& range, double forward_m) const {
  const double step_rad = kTurnStep_px / camera_.fx_px;
  const int yaws = static_cast<int>(std::ceil(range.yaw_rad / step_rad)),
            pitches = static_cast<int>(std::ceil(range.pitch_rad / step_rad));
  const auto patches = patchesAt(motion(range, forward_m, 0, 0).inverse());
  Candidate best;
  for (int yaw = -yaws; yaw <= yaws; ++yaw) {
    for (int pitch = -pitches; pitch <= pitches; ++pitch) {
      const SE3 T_then_now = motion(range, forward_m, yaw * step_rad, pitch * step_rad);
      const double value = correlation(patches, T_then_now.inverse());
      if (value > best.correlation) best = {T_then_now, value};
    }
  }
  return best;
}

}  // namespace

std::vector<SE3> localizeCoarsely(std::span<const RestingPoint> points, const ImagePyramid& then,
                                  const ImagePyramid& now, const MotionRange& range, const StereoCamera& camera) {
  const std::vector<RestingPoint> voters = chooseVoters(points, range.T_then_now.inverse(), camera);
  const TurnSearch search(voters, then, now, camera);
  const int steps = static_cast<int>(std::ceil(range.forward_m / kForwardStep_m));
  std::vector<Candidate> of_distance(static_cast<std::size_t>(2 * steps + 1));
  forEachItem(
      of_distance.size(),
      [&](std::size_t i) { of_distance[i] = search.best(range, (static_cast<int>(i) - steps) * kForwardStep_m); }, 1);
  std::vector<Candidate> peaks;
  for (std::size_t i = 0; i < of_distance.size(); ++i) {
    const double here = of_distance[i].correlation;
    const bool peak = (i == 0 || here >= of_distance[i - 1].correlation) &&
                      (i + 1 == of_distance.size() || here > of_distance[i + 1].correlation);
    if (peak && here > kMinCorrelation) peaks.push_back(of_distance[i]);
  }
  std::ranges::stable_sort(peaks, std::greater{}, &Candidate::correlation);
  if (peaks.size() > kMostCandidates) peaks.resize(kMostCandidates);
  std::vector<SE3> motions;
  for (const Candidate& peak : peaks) motions.push_back(peak.T_then_now);
  return motions;
}

}  // namespace motorcade
