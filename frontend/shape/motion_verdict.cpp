#include "frontend/shape/motion_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "frontend/shape/motion_evidence.hpp"

namespace motorcade {
namespace {

/// Distance in cells, in the earlier image, between the viewed body and what goes along with another one.
double cellsApart(const ObjectView& view, const SE3& T_before_cam, const StereoCamera& camera) {
  const auto moved = camera.project(view.well_before->T_before_body.translation()),
             along = camera.project(T_before_cam * view.T_cam_body.translation());
  return moved && along ? (moved->head<2>() - along->head<2>()).norm() / (1 << view.level) : 0;
}

}  // namespace

OtherBodies::OtherBodies(const ObjectView& view, const StereoCamera& camera) {
  const auto add = [&](const ObjectView::Other& other) {
    ObjectView::Before before = *view.well_before;
    before.T_before_cam = *other.T_before_cam;
    bodies_.push_back({Eigen::AlignedBox3d(other.least, other.most), other.T_body_cam, before});
  };
  for (const ObjectView::Other& other : view.others)
    if (other.T_before_cam) add(other);
  for (const ObjectView::Other& lost : view.lost)
    if (lost.T_before_cam && cellsApart(view, *lost.T_before_cam, camera) > ObjectView::kWellApart) add(lost);
}

const ObjectView::Before* OtherBodies::around(const Eigen::Vector3d& p_cam, double margin_m) const {
  const auto holds = [&](const Body& body) {
    return body.cuboid.squaredExteriorDistance(body.T_body_cam * p_cam) <= margin_m * margin_m;
  };
  const auto body = std::ranges::find_if(bodies_, holds);
  return body != bodies_.end() ? &body->before : nullptr;
}

namespace {

constexpr double kReach_m = 0.3;                 // of a point's surroundings, on its surface
constexpr int kSteps = 2;                        // of the samples to each side of the point
constexpr double kDepth_m = 0.5, kSlack_px = 1;  // by which its surface may leave the point's depth, and its disparity
constexpr int kLeastTold_gray = 2;               // per pixel: three standard deviations of the images' noise
constexpr double kNearlyAll = 0.75;              // of the points
constexpr int kEnough = 3;                       // points that moved, so that they are no chance
constexpr double kMost = 0.5;                    // of the points: single ones at its border rest beside a body
constexpr double kTold = 0.5;                    // of a person's patches: those beside it tell nothing
constexpr MotionEvidence::Slack kSlack{
    .cells = 1,           // by which an estimate may misplace the surface
    .disparity_px = 0.5F  // two standard deviations of a disparity
};
constexpr int kLeastAhead = 3;  // samples by which one side wins

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

/// A point of the object as it was measured, and where that is.
struct PlacedPoint {
  const PointMeasurement* measured;
  Eigen::Vector3d p_cam;
};

std::vector<PlacedPoint> placed(const std::vector<PointMeasurement>& points, const ObjectView& view,
                                const StereoCamera& camera) {
  std::vector<PlacedPoint> placed;
  for (const PointMeasurement& point : points) {
    const Eigen::Vector3d uvd_px = point.uvd_px.cast<double>() + Eigen::Vector3d(0, 0, view.disparity_offset_px);
    if (uvd_px.z() > 0) placed.push_back({&point, camera.triangulate(uvd_px)});
  }
  return placed;
}

bool isTrueOfNearlyAll(const std::vector<PlacedPoint>& points, const auto& is_true) {
  const auto of = std::ranges::count_if(points, is_true, &PlacedPoint::p_cam);
  return !points.empty() && static_cast<double>(of) >= kNearlyAll * static_cast<double>(points.size());
}

bool lieOnRoad(const std::vector<PlacedPoint>& points, const GroundPlane& ground) {
  constexpr double kNoise_m = 0.2;  // of the road's height
  return isTrueOfNearlyAll(points, [&](const Eigen::Vector3d& p_cam) { return ground.heightOf_m(p_cam) < kNoise_m; });
}

bool lieWithinAnother(const std::vector<PlacedPoint>& points, const OtherBodies& others) {
  constexpr double kMargin_m = 0.3;  // sides of cuboids are off by 0.2 m; others pass at half a meter and more
  return isTrueOfNearlyAll(points,
                           [&](const Eigen::Vector3d& p_cam) { return others.around(p_cam, kMargin_m) != nullptr; });
}

/// Surroundings of an object's points in the image, and the range of these points' depths.
struct Surroundings {
  Eigen::AlignedBox2d box_px;
  double nearest_m, middle_m, farthest_m;
};

Surroundings surroundingsOf(const std::vector<PlacedPoint>& points, const StereoCamera& camera) {
  Eigen::AlignedBox2d points_px;
  std::vector<double> depths_m;
  for (const PlacedPoint& point : points) {
    points_px.extend(point.measured->uvd_px.head<2>().cast<double>());
    depths_m.push_back(point.p_cam.z());
  }
  std::ranges::sort(depths_m);
  const double middle_m = depths_m[depths_m.size() / 2];
  const Eigen::Vector2d reach_px = Eigen::Vector2d::Constant(camera.fx_px * kReach_m / middle_m);
  return {{points_px.min() - reach_px, points_px.max() + reach_px}, depths_m.front(), middle_m, depths_m.back()};
}

/// Points at rest to one side of others in the image, and how many of them are nearer.
struct RestBeside {
  int all = 0, nearer = 0;
};

/// True when what rests to both sides of the object's points in the image is nearer than these. A body hides what is
/// behind it; a mirror image lies behind the surface that mirrors it. A body that goes behind something has this to one
/// side.
bool liesBehindRest(const Surroundings& around, const ObjectView& view, const StereoCamera& camera) {
  constexpr double kLeastDepth_m = 1;     // a body's own depth does not count
  constexpr double kSigmas = 3;           // standard deviations of a disparity
  constexpr int kLeast = 5, kBeside = 2;  // points at rest in all, and to each side
  if (around.middle_m <= kLeastDepth_m) return false;
  const double before_px = camera.fx_px * camera.baseline_m / (around.middle_m - kLeastDepth_m);
  RestBeside left, right;
  for (const ScenePoint& p : view.scene) {
    if (p.label != PointLabel::kStatic || !p.flow || !around.box_px.contains(p.uvd_px.head<2>())) continue;
    RestBeside& side = p.uvd_px.x() < around.box_px.center().x() ? left : right;
    ++side.all, side.nearer += p.uvd_px.z() > before_px + kSigmas * p.sigma_px.z();
  }
  const auto hides = [](const RestBeside& side) {
    return side.nearer >= std::max<double>(kBeside, kNearlyAll * side.all);
  };
  return hides(left) && hides(right) && left.nearer + right.nearer >= kLeast;
}

/// True when texture repeats around the object's points, at their depth: patches there are also found where they would
/// be at rest. Some points of a fence agree on a motion by bars that were taken for one another.
bool liesAmidRepeats(const Surroundings& around, const ObjectView& view, const StereoCamera& camera) {
  constexpr double kDeep_m = 1, kSigmas = 2;  // beyond the object's points, and of a depth
  constexpr double kShare = 0.4;
  constexpr int kLeast = 3;
  int all = 0, ambiguous = 0;
  for (const ScenePoint& p : view.scene) {
    if (p.label == PointLabel::kGround || !around.box_px.contains(p.uvd_px.head<2>())) continue;
    const double z_m = camera.fx_px * camera.baseline_m / p.uvd_px.z();
    const double slack_m = kDeep_m + kSigmas * z_m * p.sigma_px.z() / p.uvd_px.z();
    if (z_m < around.nearest_m - slack_m || z_m > around.farthest_m + slack_m) continue;
    ++all, ambiguous += p.ambiguous;
  }
  return all >= kLeast && ambiguous >= kShare * all;
}

/// Points around which the image moved with the body, and around which it rested, of those that were asked.
struct Votes {
  int moved = 0, rested = 0, asked = 0;
};

Votes votesOf(const std::vector<PlacedPoint>& points, const LevelDisparities& disparities, const ObjectView& view,
              const OtherBodies& others, const StereoCamera& camera) {
  constexpr int kLeast = kLeastTold_gray * MotionEvidence::kPixels;
  constexpr double kMargin_m = 0.5;  // of another's cuboid, on which the point may lie
  Votes votes{.asked = static_cast<int>(points.size())};
  for (const PlacedPoint& point : points) {
    const ObjectView::Before* other = others.around(point.p_cam, kMargin_m);
    const MotionEvidence rests_rather(disparities, view, other ? *other : *view.well_before, camera, kSlack);
    int moved = 0, rested = 0;
    for (const int rests : rests_rather(cellsAround(*point.measured, disparities, point.p_cam.z(), camera)))
      moved += -rests > kLeast, rested += rests > kLeast;
    votes.moved += moved >= rested + kLeastAhead;
    votes.rested += rested >= moved + kLeastAhead;
  }
  return votes;
}

MotionVerdict verdictOf(const Votes& votes, bool well_apart) {
  const double all = votes.moved + votes.rested;
  if (all == 0) return well_apart ? MotionVerdict::kNothing : MotionVerdict::kUntold;
  if (votes.moved >= kNearlyAll * all) return votes.moved >= kEnough ? MotionVerdict::kMoved : MotionVerdict::kHardly;
  const bool rested = votes.rested >= kNearlyAll * all && votes.rested >= kMost * votes.asked;
  return rested ? MotionVerdict::kRested : MotionVerdict::kMixed;
}

}  // namespace

bool restsDespiteEstimate(const ObjectEstimate& object, double sigma_mps) {
  constexpr double kStarted_mps = 1;  // from which on the tracker takes a stopped object as moving
  const double speed_mps = object.velocity_world_mps.norm();
  return object.state == ObjectState::kStopped && speed_mps > kStarted_mps && speed_mps > 2 * sigma_mps;
}

MotionVerdict motionVerdict(const ObjectObservation* observed, const LevelDisparities* disparities,
                            const ObjectView& view, const StereoCamera& camera) {
  if (!view.well_before) return MotionVerdict::kUntold;
  const bool well_apart = view.well_before->apart > ObjectView::kWellApart;
  if (!observed) return verdictOf({}, well_apart);
  std::vector<PlacedPoint> points = placed(observed->measured, view, camera);
  const OtherBodies others(view, camera);
  if (lieOnRoad(points, view.ground)) return MotionVerdict::kOnRoad;
  if (lieWithinAnother(points, others)) return MotionVerdict::kWithin;
  if (view.small && points.empty() && observed->patches.empty()) return MotionVerdict::kUntold;
  const bool few = view.small && std::ssize(points) < kEnough;
  if (few) std::ranges::move(placed(observed->patches, view, camera), std::back_inserter(points));
  if (!points.empty()) {
    const Surroundings around = surroundingsOf(points, camera);
    if (liesBehindRest(around, view, camera)) return MotionVerdict::kBehind;
    if (liesAmidRepeats(around, view, camera)) return MotionVerdict::kRepeats;
  }
  if (!disparities) return verdictOf({}, well_apart);
  const Votes votes = votesOf(points, *disparities, view, others, camera);
  if (votes.rested > 0 && view.well_before->apart < view.width) return MotionVerdict::kUntold;
  const bool told = !few || kTold * votes.asked <= votes.moved + votes.rested;
  return verdictOf(told ? votes : Votes{}, well_apart);
}

}  // namespace motorcade
