#include "apps/draw/seen_extent.hpp"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace motorcade {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kFewest = 5;  // points that tell an extent

double depthSigma_m(const StereoCamera& camera, const Vector3d& uvd_px) {
  constexpr double kDisparitySigma_px = 0.3;
  const double depth_m = camera.fx_px * camera.baseline_m / uvd_px.z();
  return depth_m / uvd_px.z() * kDisparitySigma_px;
}

/// Points of the object as seen in its body frame, where their depth is known well enough for its extent.
std::vector<Vector3d> pointsOnBody(const RecordedDrive& drive, std::size_t frame, TrackId track) {
  constexpr double kSharp_m = 0.5;
  constexpr std::size_t kFrames = 100;
  std::vector<Vector3d> points_body;
  for (std::size_t at = frame - std::min(frame, kFrames); at <= frame; ++at) {
    const ObjectEstimate* const object = drive.find(at, track);
    const auto seen = drive.points.find(static_cast<std::int64_t>(at));
    if (!object || seen == drive.points.end() || at >= drive.T_world_cam.size()) continue;
    const SE3 T_body_cam = object->T_world_body.inverse() * drive.T_world_cam[at];
    for (const ObjectPoint& point : seen->second) {
      if (point.track != track || !(point.uvd_px.z() > 0) || depthSigma_m(drive.camera, point.uvd_px) > kSharp_m)
        continue;
      points_body.emplace_back(T_body_cam * drive.camera.triangulate(point.uvd_px));
    }
  }
  std::erase_if(points_body, [](const Vector3d& p_body) { return !p_body.allFinite(); });
  return points_body;
}

/// The 5th and the 95th percentile of the points along an axis.
std::pair<double, double> reach(const std::vector<Vector3d>& points_body, int axis) {
  std::vector<double> values;
  for (const Vector3d& p_body : points_body) values.push_back(p_body[axis]);
  std::ranges::sort(values);
  const std::size_t cut = values.size() / 20;
  return {values[cut], values[values.size() - 1 - cut]};
}

/// Cuts the points' range to the cuboid, but keeps at least the thickness of a face.
std::pair<double, double> within(std::pair<double, double> range, double least, double most) {
  constexpr double kFace_m = 0.2;
  const double face = std::min(kFace_m, most - least);
  const double from = std::clamp(range.first, least, most - face);
  return {from, std::clamp(range.second, from + face, most)};
}

/// Shortens the length by two standard deviations. The end that faces the camera stays.
std::pair<double, double> sureOf(double least, double most, double sigma_m, bool seen_from_least) {
  const double length = std::max(0.0, most - least - 2 * sigma_m);
  return seen_from_least ? std::pair(least, least + length) : std::pair(most - length, most);
}

bool isKnown(const ObjectBox& box, int axis) {
  constexpr double kKnown_m = 0.2;
  return box.size_sigma_m[axis] <= kKnown_m;
}

}  // namespace

std::optional<SeenExtent> seenExtent(const RecordedDrive& drive, std::size_t frame, const ObjectEstimate& object) {
  const auto points_body = pointsOnBody(drive, frame, object.track);
  const bool told = points_body.size() >= kFewest;
  if (!object.cuboid && !told) return std::nullopt;
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  SeenExtent extent{Vector3d::Constant(-kNoEnd), Vector3d::Constant(kNoEnd)};
  if (object.cuboid) {
    extent.least_body = object.cuboid->center_body - 0.5 * object.cuboid->size_m;
    extent.most_body = object.cuboid->center_body + 0.5 * object.cuboid->size_m;
    if (!extent.least_body.allFinite() || !(extent.most_body.array() >= extent.least_body.array()).all())
      return std::nullopt;
  }
  const Vector3d eye_body = (object.T_world_body.inverse() * drive.T_world_cam[frame]).translation();
  for (int axis = 0; axis < 3; ++axis) {
    double &least = extent.least_body[axis], &most = extent.most_body[axis];
    if (object.cuboid && isKnown(*object.cuboid, axis)) continue;
    if (!object.cuboid)
      std::tie(least, most) = reach(points_body, axis);
    else if (told)
      std::tie(least, most) = within(reach(points_body, axis), least, most);
    else
      std::tie(least, most) =
          sureOf(least, most, object.cuboid->size_sigma_m[axis], eye_body[axis] < 0.5 * (least + most));
  }
  return extent;
}

}  // namespace motorcade
