#include "frontend/tracking/search_by_projection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "frontend/image/patch_alignment.hpp"

namespace motorcade {
namespace {

/// Alignment farther from the prediction than that of a followed point from its guess, hence surer.
constexpr PatchParams kAlignment{.max_shift_px = 6, .min_ncc = 0.75};
constexpr double kDisparitySearch_px = 2;  // around the prediction
constexpr int kStep_px = 6;                // between patches, which then share half of their pixels
constexpr double kSameDepth_px = 0.7;      // of disparity, from that of the points
constexpr double kPatchSigma_px = 0.25, kPatchDisparitySigma_px = 0.35;  // no corners: somewhat worse than those

/// Finds the point in the other pair, where it projects to `predicted_uvd_px`.
std::optional<ScenePoint> findPatch(const ScenePoint& measured, const Features& from, const Features& other,
                                    const Eigen::Vector3d& predicted_uvd_px, double disparity_offset_px) {
  const auto scale = static_cast<float>(predicted_uvd_px.z() / measured.uvd_px.z());
  const auto patch =
      makeTemplate(from.left.levels.front(), static_cast<float>(measured.uvd_px.x()),
                   static_cast<float>(measured.uvd_px.y()), kPatchWindow_px, PatchDeformation::kScale, scale);
  if (!patch) return std::nullopt;
  const Image &left = other.left.levels.front(), &right = other.right.levels.front();
  const auto aligned = alignPatch(*patch, left, predicted_uvd_px.head<2>().cast<float>(), kAlignment);
  if (!aligned) return std::nullopt;
  const auto match =
      refineDisparity(left, right, aligned->u_px, aligned->v_px, predicted_uvd_px.z() - disparity_offset_px,
                      {.search_radius_px = kDisparitySearch_px});
  if (!match) return std::nullopt;
  ScenePoint found{.point = measured.point,
                   .uvd_px = {aligned->u_px, aligned->v_px, match->disparity_px + disparity_offset_px},
                   .sigma_px = measured.sigma_px,
                   .flow = {}};
  found.sigma_px = found.sigma_px.cwiseMax(Eigen::Vector3d(aligned->sigma_px, aligned->sigma_px, match->sigma_px));
  return found;
}

/// Step between patches that cover a box.
int stepOf(const Box& box, int most) {
  const double area_px2 = (box.right_px - box.left_px) * (box.bottom_px - box.top_px);
  return std::max(kStep_px, static_cast<int>(std::sqrt(area_px2 / most)));
}

double medianDisparity_px(const std::vector<ScenePoint>& points) {
  std::vector<double> disparities_px;
  for (const ScenePoint& p : points) disparities_px.push_back(p.uvd_px.z());
  const auto middle = disparities_px.begin() + std::ssize(disparities_px) / 2;
  std::ranges::nth_element(disparities_px, middle);
  return *middle;
}

}  // namespace

std::vector<ScenePoint> samplePatches(const Features& features, const Box& box, double disparity_px,
                                      double disparity_offset_px, int most) {
  const int step_px = stepOf(box, most);
  const Image &left = features.left.levels.front(), &right = features.right.levels.front();
  std::vector<ScenePoint> patches;
  for (double v = box.top_px; v <= box.bottom_px; v += step_px) {
    for (double u = box.left_px; u <= box.right_px; u += step_px) {
      const auto match = refineDisparity(left, right, u, v, disparity_px - disparity_offset_px,
                                         {.search_radius_px = kDisparitySearch_px});
      if (!match || std::abs(match->disparity_px + disparity_offset_px - disparity_px) > kSameDepth_px) continue;
      patches.push_back(
          {.point = {-1 - std::ssize(patches)},
           .uvd_px = {u, v, match->disparity_px + disparity_offset_px},
           .sigma_px = {kPatchSigma_px, kPatchSigma_px, std::max<double>(match->sigma_px, kPatchDisparitySigma_px)},
           .flow = {}});
    }
  }
  return patches;
}

double shareAtDepth(const Features& features, const Box& box, double disparity_px, double disparity_offset_px,
                    int most) {
  const int step_px = stepOf(box, most);
  const int columns = static_cast<int>((box.right_px - box.left_px) / step_px) + 1,
            rows = static_cast<int>((box.bottom_px - box.top_px) / step_px) + 1;
  const auto found = samplePatches(features, box, disparity_px, disparity_offset_px, most).size();
  return static_cast<double>(found) / (columns * rows);
}

std::vector<ScenePoint> samplePatches(const MeasuredPoints& measured, double disparity_offset_px) {
  if (!measured.features || measured.points.empty()) return {};
  Eigen::AlignedBox2d box;
  for (const ScenePoint& p : measured.points) box.extend(Eigen::Vector2d(p.uvd_px.head<2>()));
  return samplePatches(*measured.features, {box.min().x(), box.min().y(), box.max().x(), box.max().y()},
                       medianDisparity_px(measured.points), disparity_offset_px);
}

std::vector<ScenePoint> searchByProjection(const TrackedObject& body, const MeasuredPoints& measured,
                                           const Features& other, const SE3& T_cam_body, double disparity_offset_px,
                                           const StereoCamera& camera) {
  std::vector<ScenePoint> found;
  if (!measured.features || other.frame->rejected()) return found;
  for (const ScenePoint& point : measured.points) {
    const BodyPoint* of_body = body.find(point.point);
    const auto uvd_px = of_body ? camera.project(T_cam_body * of_body->p_body) : std::nullopt;
    if (!uvd_px || !camera.inLeftImage(uvd_px->x(), uvd_px->y())) continue;
    if (auto here = findPatch(point, *measured.features, other, *uvd_px, disparity_offset_px))
      found.push_back(std::move(*here));
  }
  return found;
}

}  // namespace motorcade
