#include "frontend/motion/gap_bridge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/patch_alignment.hpp"
#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

// How the camera may have moved otherwise than predicted.
constexpr double kAcceleration_mps2 = 8, kMaxYawRate_radps = 0.5;
constexpr double kSpeedError_mps = 2;  // of the prediction
constexpr int kReachLevel = 2;         // four pixels here are sixteen, more than a step of the coarse search
constexpr double kDisparitySearch_px = 3;
constexpr PatchParams kCoarse{.max_step_px = 0.1, .min_ncc = 0.6};
constexpr PatchParams kFine{.max_shift_px = 4, .min_ncc = 0.7};
constexpr float kSeenAnew =
    1.5F;  // times the standard deviation: the patch has grown, and its surroundings have changed
constexpr float kMinSigma_px = 0.25F;
constexpr int kMinAgreeing = 20;           // points on a motion over a gap ...
constexpr double kMinAgreeingShare = 0.4;  // ... and of those that were found

/// Aligns the point in the left image of now from a guess, coarse to fine; the patch is enlarged as the point came
/// nearer.
std::optional<AlignedPatch> align(const RestingPoint& point, const Features& then, const Features& now,
                                  Eigen::Vector2f at_px, float scale, int first_level) {
  std::optional<AlignedPatch> found;
  const int coarsest = static_cast<int>(then.left.levels.size()) - 1;
  for (int level = std::min(first_level, coarsest); level >= 0; --level) {
    const auto patch = makeTemplate(then.left.levels[level], toLevel(static_cast<float>(point.uvd_px.x()), level),
                                    toLevel(static_cast<float>(point.uvd_px.y()), level), kPatchWindow_px,
                                    PatchDeformation::kScale, scale);
    if (!patch && level > 0) continue;  // without texture at this level
    if (!patch) return std::nullopt;
    const Eigen::Vector2f guess_px(toLevel(at_px.x(), level), toLevel(at_px.y(), level));
    found = alignPatch(*patch, now.left.levels[level], guess_px, level > 0 ? kCoarse : kFine);
    if (!found) return std::nullopt;
    const auto full = static_cast<float>(1 << level);
    at_px = {(found->u_px + 0.5F) * full - 0.5F, (found->v_px + 0.5F) * full - 0.5F};
  }
  return found;
}

}  // namespace

std::vector<FlowObservation> GapBridge::search(const Gap& gap, const SE3& T_then_now, int first_level) const {
  const SE3 T_now_then = T_then_now.inverse();
  std::vector<std::optional<FlowObservation>> at(gap.points.size());
  forEachItem(gap.points.size(), [&](std::size_t i) {
    const RestingPoint& point = gap.points[i];
    const auto uvd_px = camera_.project(T_now_then * point.p_cam);
    if (!uvd_px || !camera_.inLeftImage(uvd_px->x(), uvd_px->y(), kPatchWindow_px / 2.0)) return;
    const auto scale = static_cast<float>(uvd_px->z() / point.uvd_px.z());
    const auto found = align(point, gap.then, gap.now, uvd_px->head<2>().cast<float>(), scale, first_level);
    if (found && camera_.inLeftImage(found->u_px, found->v_px, kPatchWindow_px / 2.0))
      at[i] = {point.point,
               found->u_px,
               found->v_px,
               kSeenAnew * std::max(found->sigma_px, kMinSigma_px),
               point.observations + 1,
               -1};
  });
  std::vector<FlowObservation> found;
  for (const auto& o : at)
    if (o) found.push_back(*o);
  return found;
}

/// Fits a motion by RANSAC to what was found, with disparities in the new pair; empty when too few agree.
std::optional<SE3> GapBridge::fit(const Gap& gap, const std::vector<FlowObservation>& found,
                                  const SE3& T_then_now) const {
  const SE3 T_now_then = T_then_now.inverse();
  std::vector<PoseObservation> observations;
  auto point = gap.points.begin();
  for (const FlowObservation& o : found) {
    while (point->point != o.point) ++point;
    const auto expected_px = camera_.project(T_now_then * point->p_cam);
    const auto match =
        refineDisparity(gap.now.left.levels.front(), gap.now.right.levels.front(), o.u_px, o.v_px,
                        expected_px->z() - gap.disparity_offset_px, {.search_radius_px = kDisparitySearch_px});
    if (!match) continue;
    const Eigen::Matrix3d J = camera_.triangulationJacobian(point->uvd_px);
    const double sigma_px = 2 * std::max<double>(o.sigma_px, 2 * kPatchSigmaFloor_px);
    observations.push_back({point->p_cam,
                            sigma_px * sigma_px * J * J.transpose(),
                            {o.u_px, o.v_px, match->disparity_px + gap.disparity_offset_px},
                            Eigen::Vector3d::Constant(sigma_px)});
  }
  const PredictedMotion predicted{T_then_now, gap.duration_s, 0, gap.ahead_frames, gap.R_cam_level};
  const auto ego = ego_motion_(observations, std::vector<PointLabel>(observations.size(), PointLabel::kUnknown),
                               predicted, static_cast<std::uint64_t>(gap.now.frame->head.frame.value));
  if (!ego || ego->inlier_count < kMinAgreeing) return std::nullopt;
  if (ego->inlier_count < kMinAgreeingShare * static_cast<double>(observations.size())) return std::nullopt;
  return ego->T_seen_now;
}

std::optional<SE3> GapBridge::locate(const Gap& gap, const SE3& predicted_T_then_now) const {
  const double t = gap.duration_s;
  const MotionRange range{.T_then_now = predicted_T_then_now,
                          .forward_m = kSpeedError_mps * t + 0.5 * kAcceleration_mps2 * t * t,
                          .yaw_rad = kMaxYawRate_radps * t};
  for (const SE3& coarse : localizeCoarsely(gap.points, gap.then.left, gap.now.left, range, camera_)) {
    const auto near = fit(gap, search(gap, coarse, kReachLevel), coarse);
    if (!near) continue;
    if (auto found = fit(gap, search(gap, *near, 0), *near)) return found;
  }
  return std::nullopt;
}

std::vector<FlowObservation> GapBridge::find(const Gap& gap, const SE3& T_then_now) const {
  return search(gap, T_then_now, 0);
}

}  // namespace motorcade
