#include "frontend/shape/motion_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "frontend/shape/motion_evidence.hpp"

namespace motorcade {
namespace {

constexpr double kReach_m = 0.3;                 // of a point's surroundings, on its surface
constexpr int kSteps = 2;                        // of the samples to each side of the point
constexpr double kDepth_m = 0.5, kSlack_px = 1;  // by which its surface may leave the point's depth, and its disparity
constexpr int kLeastTold_gray = 2;               // per pixel: three standard deviations of the images' noise
constexpr double kNearlyAll = 0.75;              // of the points with a vote
constexpr int kSlack = 1;                        // cells by which an estimate may misplace the surface
constexpr int kLeastAhead = 3;                   // samples by which one side wins

/// What goes along with another object, in place of what rests: a pattern that repeats on its flank may seem to go
/// another way.
struct AgainstOther {
  Eigen::AlignedBox3d reach;  // of the other, in its body frame
  SE3 T_body_cam;
  ObjectView::Before before;
};

/// The cells of the map that show the surface around a point.
std::vector<int> cellsAround(const PointMeasurement& point, const LevelDisparities& disparities, double z_m,
                             const StereoCamera& camera) {
  const PixelWindow& window = disparities.map.window;
  const double cell_px = 1 << disparities.level;
  const double spacing = std::max(1.0, camera.fx_px * kReach_m / z_m / cell_px / kSteps);  // cells
  const double tolerance_px = kSlack_px + point.uvd_px.z() * kDepth_m / z_m;
  std::vector<int> cells;
  for (int j = -kSteps; j <= kSteps; ++j)
    for (int i = -kSteps; i <= kSteps; ++i) {
      const int column = static_cast<int>(std::lround(point.uvd_px.x() / cell_px + i * spacing)) - window.u0;
      const int row = static_cast<int>(std::lround(point.uvd_px.y() / cell_px + j * spacing)) - window.v0;
      if (column < 0 || row < 0 || column >= window.width || row >= window.height) continue;
      const auto disparity_px = disparities.disparity_px(column, row);
      if (disparity_px && std::abs(*disparity_px - point.uvd_px.z()) < tolerance_px)
        cells.push_back(row * window.width + column);
    }
  return cells;
}

/// The view against the object on which the point may lie; null where it lies on none.
const ObjectView::Before* againstOther(const Eigen::Vector3d& p_cam, std::span<const AgainstOther> against) {
  const auto holds = [&](const AgainstOther& other) { return other.reach.contains(other.T_body_cam * p_cam); };
  const auto of = std::ranges::find_if(against, holds);
  return of != against.end() ? &of->before : nullptr;
}

std::vector<AgainstOther> againstOthers(const ObjectView& view) {
  constexpr double kMargin_m = 0.5;  // of another's cuboid
  std::vector<AgainstOther> against;
  for (const ObjectView::Other& other : view.others) {
    if (!other.T_before_cam) continue;
    Eigen::AlignedBox3d reach(other.least, other.most);
    reach.min().array() -= kMargin_m, reach.max().array() += kMargin_m;
    against.push_back({reach, other.T_body_cam, *view.well_before});
    against.back().before.T_before_cam = *other.T_before_cam;
  }
  return against;
}

/// Points around which the image moved with the body, and around which it rested.
struct Votes {
  int moved = 0, rested = 0;
};

Votes votesOf(const std::vector<PointMeasurement>& points, const LevelDisparities& disparities, const ObjectView& view,
              const StereoCamera& camera) {
  constexpr int kLeast = kLeastTold_gray * MotionEvidence::kPixels;
  const std::vector<AgainstOther> against = againstOthers(view);
  Votes votes;
  for (const PointMeasurement& point : points) {
    const Eigen::Vector3d uvd_px = point.uvd_px.cast<double>() + Eigen::Vector3d(0, 0, view.disparity_offset_px);
    if (uvd_px.z() <= 0) continue;
    const Eigen::Vector3d p_cam = camera.triangulate(uvd_px);
    const ObjectView::Before* other = againstOther(p_cam, against);
    const MotionEvidence rests_rather(disparities, view, other ? *other : *view.well_before, camera, kSlack);
    int moved = 0, rested = 0;
    for (const int rests : rests_rather(cellsAround(point, disparities, p_cam.z(), camera)))
      moved += -rests > kLeast, rested += rests > kLeast;
    votes.moved += moved >= rested + kLeastAhead;
    votes.rested += rested >= moved + kLeastAhead;
  }
  return votes;
}

}  // namespace

MotionVerdict motionVerdict(const ObjectObservation* observed, const LevelDisparities* disparities,
                            const ObjectView& view, const StereoCamera& camera) {
  if (!view.well_before) return MotionVerdict::kUntold;
  const Votes votes = observed && disparities ? votesOf(observed->measured, *disparities, view, camera) : Votes{};
  const double all = votes.moved + votes.rested;
  if (all == 0)
    return view.well_before->apart > ObjectView::kWellApart ? MotionVerdict::kNothing : MotionVerdict::kUntold;
  if (votes.moved >= kNearlyAll * all) return MotionVerdict::kMoved;
  return votes.rested >= kNearlyAll * all ? MotionVerdict::kRested : MotionVerdict::kMixed;
}

}  // namespace motorcade
