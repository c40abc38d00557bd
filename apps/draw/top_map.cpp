#include "apps/draw/top_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace motorcade {
namespace {

using Eigen::Array2d, Eigen::Vector3d;

/// Meters ahead and to the right of the camera.
struct Extent {
  Array2d least{-9, -4}, most{26, 4};

  /// Makes room for a point unless it is too far off.
  void include(const Vector3d& p_cam, double margin_m) {
    const Array2d farthest(90, 22), rearmost(-12, -22), at(p_cam.z(), p_cam.x());
    if (!at.allFinite() || (at < rearmost).any() || (at > farthest).any()) return;
    least = least.min((at - margin_m).max(rearmost));
    most = most.max((at + margin_m).min(farthest));
  }
};

Extent extentAt(const RecordedDrive& drive, std::size_t frame) {
  constexpr double kObject_m = 3, kArrow_m = 1, kNearTruth_m = 60, kBesideTruth_m = 20;
  Extent extent;
  const SE3 T_cam_world = drive.T_world_cam[frame].inverse();
  for (const ObjectEstimate& object : drive.objectsAt(frame)) {
    const Vector3d p_world = object.T_world_body.translation();
    extent.include(T_cam_world * p_world, kObject_m);
    extent.include(T_cam_world * (p_world + object.velocity_world_mps), kArrow_m);
  }
  const auto truths = drive.true_objects.find(static_cast<std::int64_t>(frame));
  if (truths == drive.true_objects.end() || frame >= drive.T_world_cam_true.size()) return extent;
  const SE3 T_cam_world_true = drive.T_world_cam_true[frame].inverse();
  for (const ObjectTruth& truth : truths->second) {
    const Vector3d p_cam = T_cam_world_true * truth.T_world_object.translation();
    if (!drive.true_movers.contains(truth.id) || p_cam.z() < 0 || p_cam.z() > kNearTruth_m) continue;
    if (std::abs(p_cam.x()) < kBesideTruth_m) extent.include(p_cam, kObject_m);
  }
  return extent;
}

/// Mean over the frames around this one. Each term is the extent that holds all extents around its frame, and so this
/// frame's own.
Extent smoothExtent(const RecordedDrive& drive, std::size_t frame) {
  constexpr std::ptrdiff_t kBeside = 6;
  const auto last = static_cast<std::ptrdiff_t>(drive.T_world_cam.size()) - 1,
             middle = static_cast<std::ptrdiff_t>(frame);
  std::vector<Extent> extents;
  for (std::ptrdiff_t at = middle - 2 * kBeside; at <= middle + 2 * kBeside; ++at)
    extents.push_back(extentAt(drive, static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at, 0, last))));
  Extent mean{Array2d::Zero(), Array2d::Zero()};
  for (std::size_t from = 0; from <= 2 * kBeside; ++from) {
    Extent whole = extents[from];
    for (std::size_t i = from; i <= from + 2 * kBeside; ++i) {
      whole.least = whole.least.min(extents[i].least);
      whole.most = whole.most.max(extents[i].most);
    }
    mean.least += whole.least / (2 * kBeside + 1);
    mean.most += whole.most / (2 * kBeside + 1);
  }
  return mean;
}

}  // namespace

TopMap topMapOf(const RecordedDrive& drive, std::size_t frame, const Rectangle& area) {
  constexpr double kRoomBehind = 0.3;
  const Extent extent = frame < drive.T_world_cam.size() ? smoothExtent(drive, frame) : Extent{};
  const Array2d span_m = extent.most - extent.least, size_px(area.width, area.height);
  TopMap map;
  map.px_per_m = std::max(1e-3, (size_px / span_m).minCoeff());
  // Spare room goes ahead rather than behind, and equally to both sides.
  const Array2d room_px = size_px - map.px_per_m * span_m, before_px = room_px * Array2d(kRoomBehind, 0.5);
  map.origin_px = Eigen::Vector2d(area.left, area.top) + (before_px - map.px_per_m * extent.least).matrix();
  return map;
}

}  // namespace motorcade
