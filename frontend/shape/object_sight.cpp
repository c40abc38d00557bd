#include "frontend/shape/object_sight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/shape/dense_disparity.hpp"
#include "frontend/shape/outline.hpp"
#include "frontend/shape/outline_completion.hpp"

namespace motorcade {
namespace {

/// True when no part of a cuboid is in the left image, even if it is larger by a standard deviation at each side.
bool hasLeft(const ObjectBox& box, const SE3& T_cam_body, const StereoCamera& camera) {
  const Eigen::Vector3d half_m = 0.5 * box.size_m + box.size_sigma_m;
  return !projectedBox(box.center_body - half_m, box.center_body + half_m, T_cam_body, camera);
}

}  // namespace

bool isCutOff(const Box& points, const SE3& T_cam_body, const StereoCamera& camera) {
  constexpr double kBorder_px = 40;
  const double disparity_px = camera.fx_px * camera.baseline_m / T_cam_body.translation().z();
  return points.left_px < disparity_px + kBorder_px || points.right_px > camera.width_px - kBorder_px;
}

double shareInImages(const ObjectBox& box, const SE3& T_cam_body, const StereoCamera& camera) {
  constexpr double kNear_m = 1;
  const Eigen::Vector3d least = box.center_body - 0.5 * box.size_m, most = box.center_body + 0.5 * box.size_m;
  double left_px = 1e9, right_px = -1e9, hidden_px = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p_cam = T_cam_body * cornerOf(least, most, corner);
    if (p_cam.z() < kNear_m) return 0;
    const double u_px = camera.cx_px + camera.fx_px * p_cam.x() / p_cam.z();
    if (u_px < left_px) left_px = u_px, hidden_px = camera.fx_px * camera.baseline_m / p_cam.z();
    right_px = std::max(right_px, u_px);
  }
  return (std::min(right_px, camera.width_px - 1.0) - std::max(left_px, hidden_px)) / (right_px - left_px);
}

void dropLeft(FrameEstimate& frame, const StereoCamera& camera) {
  constexpr double kMostly = 0.5;
  std::erase_if(frame.objects, [&](const ObjectEstimate& object) {
    if (!object.cuboid) return false;
    const SE3 T_cam_body = frame.T_world_cam.inverse() * object.T_world_body;
    if (object.state != ObjectState::kPredicted) return hasLeft(*object.cuboid, T_cam_body, camera);
    return shareInImages(*object.cuboid, T_cam_body, camera) < kMostly;
  });
}

namespace {

constexpr double kMargin = 0.2;  // of the window around the box in the image, on each side
constexpr int kMargin_px = 8, kMostCells = 5'000, kFinestLevel = 1;
constexpr int kRefinements = 2;  // of the disparities: levels of the pyramid, finer than theirs
constexpr double kBefore_m = 2;  // how far before the cuboid disparities are told apart; behind it, all are
constexpr int kLeastCells = 30;  // of an outline that is believed

}  // namespace

int ObjectSight::levelOf(const ObjectView& view, int levels) const {
  int level = kFinestLevel;
  const auto box = usualBox(view);
  if (!box) return level;
  const double width_px = box->right_px - box->left_px, height_px = box->bottom_px - box->top_px;
  const auto cells = [&] { return (1 + 2 * kMargin) * (1 + 2 * kMargin) * width_px * height_px / (1 << 2 * level); };
  while (cells() > kMostCells && level + 1 < levels) ++level;
  return level;
}

std::optional<Sight> ObjectSight::operator()(const ObjectView& view, const Features& features) {
  if (features.right.levels.size() <= kFinestLevel) return std::nullopt;
  auto disparities = disparitiesAround(view, features);
  if (!disparities) return std::nullopt;
  const std::vector<int> cells = cellsInReach(*disparities, view, camera_);
  refine(*disparities, cells, features);
  Outline outline = findOutline(*disparities, cells, view, camera_);
  if (outline.count() < kLeastCells) return std::nullopt;
  Sight sight{std::move(*disparities), std::move(outline)};
  if (const auto& labels = features.frame->inputs.instances)
    sight.labelled = labelledOutline(sight.outline, sight.disparities, *labels);
  return sight;
}

std::optional<Box> ObjectSight::usualBox(const ObjectView& view) const {
  return projectedBox(view.box.usual_least, view.box.usual_most, view.T_cam_body, camera_);
}

std::optional<LevelDisparities> ObjectSight::disparitiesAround(const ObjectView& view, const Features& features) {
  const auto box = usualBox(view);
  if (!box) return std::nullopt;
  const double width_px = box->right_px - box->left_px, height_px = box->bottom_px - box->top_px;
  const int level = view.level;
  const auto cell = [&](double px) { return static_cast<int>(std::floor(toLevel(static_cast<float>(px), level))); };
  const double aside_px = kMargin * width_px + kMargin_px, above_px = kMargin * height_px + kMargin_px;
  PixelWindow window{.u0 = cell(box->left_px - aside_px), .v0 = cell(box->top_px - above_px), .width = 0, .height = 0};
  window.width = cell(box->right_px + aside_px) - window.u0 + 1;
  window.height = cell(box->bottom_px + above_px) - window.v0 + 1;

  double near_m = std::numeric_limits<double>::max();
  for (int corner = 0; corner < 8; ++corner) {
    const double z = (view.T_cam_body * cornerOf(view.box.usual_least, view.box.usual_most, corner)).z();
    near_m = std::min(near_m, z);
  }
  constexpr double kNearest_m = 1.5;
  const double fb = camera_.fx_px * camera_.baseline_m;
  const int most_px = static_cast<int>(std::ceil(fb / std::max(near_m - kBefore_m, kNearest_m) / (1 << level))) + 1;
  LevelDisparities disparities{
      .level = level,
      .map = dense_disparity_(features.left.levels[level], features.right.levels[level], window, {0, most_px + 1})};
  if (disparities.map.window.empty()) return std::nullopt;
  return disparities;
}

void ObjectSight::refine(LevelDisparities& disparities, std::span<const int> cells, const Features& features) {
  const int level = disparities.level;
  for (int finer = level - 1; finer >= std::max(0, level - kRefinements); --finer)
    refineDisparities(features.left.levels[finer], features.right.levels[finer], 1 << (level - finer), cells,
                      disparities.map);
}

}  // namespace motorcade
