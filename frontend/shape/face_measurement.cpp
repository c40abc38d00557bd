#include "frontend/shape/face_measurement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

constexpr double kSurfaceSigma_px = 0.5;     // of a dense disparity, in pixels of its level
constexpr double kUneven_m = 0.15;           // how far a vehicle's sides lie from a plane
constexpr double kIndependent = 12;          // distances of one face: its errors have much in common
constexpr double kGrossChi = 3;              // from here on a distance counts less and less (Cauchy)
constexpr double kLow_m = 0.2, kHigh = 0.6;  // above the road, and of the height: between, sides are upright
constexpr double kBoundSigma_px = 1.5, kRounded_m = 0.08;  // of a bound of the outline, in pixels of its level
constexpr double kRoadSigma_m = 0.05, kRoadSlope = 0.004;  // of the road's height, per meter away
constexpr double kPointSigma_m = 0.3;                      // of the outermost points of an object
constexpr double kNearCorner_m = 1.5;                      // nearer corners are seen too much from the side
constexpr double kSharp_m = 0.35;    // noise in depth of surface points that tell how far the object reaches
constexpr double kOutermost = 0.05;  // share of them, at each side, that may be of something else
constexpr double kExtentSigma_m = 0.1;
constexpr std::size_t kLeastSharp = 30;
constexpr double kGoesOnSigmas = 2;  // by which a side goes on beyond the sharp part of it
constexpr int kEdge = 3;             // cells from the window's edge, where the window cuts the outline

/// A point of the surface, with its noise along the ray.
struct Sample {
  Eigen::Vector3d p_body;
  double noise_m;
};

/// The last sample toward a face, but for a share of outliers.
Sample outermost(std::vector<Sample>& samples, int face) {
  const double share = outward(face) > 0 ? 1 - kOutermost : kOutermost;
  const auto nth = samples.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(samples.size() - 1));
  std::ranges::nth_element(samples, nth, {}, [axis = face / 2](const Sample& sample) { return sample.p_body[axis]; });
  return *nth;
}

class FaceMeasurement {
 public:
  FaceMeasurement(const LevelDisparities& disparities, const Outline& outline, std::span<const SurfacePoint> surface,
                  const ObjectView& view, const StereoCamera& camera)
      : disparities_(disparities),
        outline_(outline),
        surface_(surface),
        view_(view),
        camera_(camera),
        origin_(-view.T_cam_body.rotation().transpose() * view.T_cam_body.translation()) {}

  FaceInformation operator()() {
    addRoad();
    addPoints();
    addSurfaces();
    addBounds();
    return information_;
  }

 private:
  void addRoad();
  void addPoints();
  void addSurfaces();
  /// Evidence of surface points on where their face is: a weighted sum.
  struct Surface {
    double points = 0, weight = 0, sum = 0, sum_of_squares = 0;
  };
  void addSurfacePoint(const SurfacePoint& point, std::array<Surface, 6>& surfaces);
  void addExtent();
  void reachTo(int face, double at, double sigma_m);
  bool isFlankInView() const;
  void addBounds();
  bool isCut(int column, int step) const;
  /// One side of the outline; where it is cut, the object reaches at least so far.
  struct Bound {
    double at_px, sigma_px;
    bool horizontal, least, cut;
  };
  void addBound(const Bound& bound);

  const LevelDisparities& disparities_;
  const Outline& outline_;
  std::span<const SurfacePoint> surface_;
  const ObjectView& view_;
  const StereoCamera& camera_;
  Eigen::Vector3d origin_;  // of the camera, in the body frame
  FaceInformation information_;
  std::vector<Sample> sampled_, sharp_;  // the surface, and what is known sharply of it
};

/// Adds the road: the middle of the bottom face lies on it.
void FaceMeasurement::addRoad() {
  const Eigen::Vector3d down_body = view_.T_cam_body.rotation().transpose() * view_.ground.normal_cam;
  Vector6d row;
  row << 0.5 * down_body.x(), 0.5 * down_body.x(), 0.5 * down_body.y(), 0.5 * down_body.y(), down_body.z(), 0;
  const double value = view_.ground.heightOf_m(view_.T_cam_body.translation());
  information_.add(row, value, kRoadSigma_m + kRoadSlope * view_.T_cam_body.translation().norm());
}

/// Adds the points by which the object is followed: the cuboid holds them.
void FaceMeasurement::addPoints() {
  if (!view_.points) return;
  for (int axis = 0; axis < 3; ++axis) {
    reachTo(2 * axis, view_.points->min()[axis], kPointSigma_m);
    reachTo(2 * axis + 1, view_.points->max()[axis], kPointSigma_m);
  }
}

/// Adds that a face lies at `at` or beyond. Where the flank is in view, it was seen to end: rear or front lies there.
void FaceMeasurement::reachTo(int face, double at, double sigma_m) {
  if (outward(face) * (at - view_.box.faces[face]) <= 0) return;
  if (face <= kFront && isFlankInView())
    information_.add(Vector6d::Unit(face), at, sigma_m);
  else
    information_.addReach(face, at, sigma_m);
}

/// True when the camera is to a side of the cuboid, so that its end does not hide how long it is.
bool FaceMeasurement::isFlankInView() const {
  return origin_.y() < view_.box.faces[kRight] || origin_.y() > view_.box.faces[kLeft];
}

void FaceMeasurement::addSurfaces() {
  std::array<Surface, 6> surfaces{};
  for (const SurfacePoint& point : surface_) addSurfacePoint(point, surfaces);
  for (std::size_t face = 0; face < surfaces.size(); ++face) {
    const Surface& surface = surfaces[face];
    if (surface.points <= 0) continue;
    FaceInformation of_face;
    of_face.H(face, face) = surface.weight, of_face.b[face] = surface.sum, of_face.c = surface.sum_of_squares;
    information_.add(of_face, std::min(1.0, kIndependent / surface.points));
  }
  addExtent();
}

/// Adds that the cuboid holds the sharply known surface, all but its outermost parts. The flank of a lorry that goes on
/// where it is no longer sharp ends farther ahead or behind: its sharp part would keep the cuboid as short as itself.
void FaceMeasurement::addExtent() {
  if (sharp_.size() < kLeastSharp) return;
  for (const int face : {kRear, kFront, kRight, kLeft}) {
    const int axis = face / 2;
    const Sample sharp = outermost(sharp_, face), any = outermost(sampled_, face);
    const bool goes_on =
        axis == 0 && outward(face) * (any.p_body[axis] - sharp.p_body[axis]) > kGoesOnSigmas * any.noise_m;
    if (goes_on)
      reachTo(face, any.p_body[axis], any.noise_m);
    else
      reachTo(face, sharp.p_body[axis], kExtentSigma_m);
  }
}

/// Adds a surface point: the ray through its cell meets an upright face at the distance that the disparity says.
void FaceMeasurement::addSurfacePoint(const SurfacePoint& point, std::array<Surface, 6>& surfaces) {
  const BoxFaces& faces = view_.box.faces;
  if (point.height_m > kHigh * (faces[kTop] - faces[kBottom])) return;
  const Eigen::Vector3d& direction = point.direction_body;
  const double z = point.depth_m, noise_m = point.noise_m;
  int face = -1;
  double entry = 0;
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(direction[axis]) < 1e-6) continue;
    const int near = direction[axis] > 0 ? 2 * axis : 2 * axis + 1;
    const double t = (faces[near] - origin_[axis]) / direction[axis];
    if (t > entry) entry = t, face = near;
  }
  if (face < 0) return;
  const double along = direction[face / 2];
  const Sample sample{origin_ + z * direction, noise_m * direction.norm()};
  sampled_.push_back(sample);
  if (noise_m < kSharp_m) sharp_.push_back(sample);
  const double sigma_z = hypotenuse(noise_m, kUneven_m / std::abs(along));
  const double chi = (z - entry) / sigma_z, weight = 1 / (1 + chi * chi / (kGrossChi * kGrossChi));
  if (chi < -kGrossChi) return;  // before the cuboid: of another face, which reaches farther than is believed
  const double at = origin_[face / 2] + z * along, information = weight / (sigma_z * sigma_z * along * along);
  Surface& surface = surfaces[face];
  surface.points += weight, surface.weight += information;
  surface.sum += information * at, surface.sum_of_squares += information * at * at;
}

void FaceMeasurement::addBounds() {
  const PixelWindow bounds = outline_.bounds();
  if (bounds.empty()) return;
  const int scale = 1 << disparities_.level;
  const double half_cell_px = 0.5 * scale, sigma_px = kBoundSigma_px * scale;
  const double left_px = disparities_.u_px(bounds.u0) - half_cell_px,
               right_px = disparities_.u_px(bounds.u0 + bounds.width - 1) + half_cell_px,
               top_px = disparities_.v_px(bounds.v0) - half_cell_px;
  addBound({left_px, sigma_px, true, true, bounds.u0 < kEdge || isCut(bounds.u0, -1)});
  addBound({right_px, sigma_px, true, false,
            bounds.u0 + bounds.width > outline_.window.width - kEdge || isCut(bounds.u0 + bounds.width - 1, 1)});
  addBound({top_px, sigma_px, false, true, bounds.v0 < kEdge});
}

/// True when what lies beside a bound of the outline is nearer than the object, or as near.
bool FaceMeasurement::isCut(int column, int step) const {
  constexpr int kFrom = 3, kTo = 6;    // cells beside the bound; the nearest are often taken for the object's
  constexpr double kBehind_px = -1.5;  // of the level's disparity
  int nearer = 0, cells = 0;
  for (int row = 0; row < outline_.window.height; ++row) {
    if (!outline_.at(column, row)) continue;
    const auto own = disparities_.disparity_px(column, row);
    for (int k = kFrom; k <= kTo; ++k) {
      const int beside = column + k * step;
      if (beside < 0 || beside >= outline_.window.width) continue;
      const auto other = disparities_.disparity_px(beside, row);
      if (!own || !other) continue;
      ++cells;
      nearer += *other > *own + kBehind_px * (1 << disparities_.level);
    }
  }
  return 2 * nearer > cells;
}

/// Adds a bound: the cuboid's outermost corner in one direction of the image is seen there.
void FaceMeasurement::addBound(const Bound& bound) {
  const auto [bound_px, sigma_px, horizontal, least, cut] = bound;
  double extreme = least ? std::numeric_limits<double>::max() : std::numeric_limits<double>::lowest();
  Vector6d row = Vector6d::Zero();
  double depth_m = 1;
  const BoxFaces& faces = view_.box.faces;
  for (int corner = 0; corner < 8; ++corner) {
    const std::array<int, 3> at{kRear + (corner & 1), kRight + (corner >> 1 & 1), kBottom + (corner >> 2 & 1)};
    const Eigen::Vector3d p_cam = view_.T_cam_body * Eigen::Vector3d(faces[at[0]], faces[at[1]], faces[at[2]]);
    const auto uvd_px = camera_.project(p_cam);
    if (!uvd_px || p_cam.z() < kNearCorner_m) return;
    const double seen_px = horizontal ? uvd_px->x() : uvd_px->y();
    if (least ? seen_px >= extreme : seen_px <= extreme) continue;
    extreme = seen_px;
    depth_m = p_cam.z();
    const Eigen::RowVector3d J =
        camera_.projectionJacobian(p_cam).row(horizontal ? 0 : 1) * view_.T_cam_body.rotation();
    row.setZero();
    for (int axis = 0; axis < 3; ++axis) row[at[axis]] = J[axis];
  }
  if (cut && (least ? extreme <= bound_px : extreme >= bound_px)) return;
  const double rounded_px = kRounded_m * camera_.fx_px / depth_m;
  information_.add(row, bound_px - extreme + row.dot(faces), hypotenuse(sigma_px, rounded_px));
}

}  // namespace

std::vector<SurfacePoint> surfacePoints(const LevelDisparities& disparities, const Outline& outline,
                                        const ObjectView& view, const StereoCamera& camera) {
  const Eigen::Matrix3d R_body_cam = view.T_cam_body.rotation().transpose();
  std::vector<SurfacePoint> points;
  for (const int cell : outline.samples()) {
    const int column = cell % outline.window.width, row = cell / outline.window.width;
    const auto disparity_px = disparities.disparity_px(column, row);
    if (!disparity_px) continue;
    const double d = *disparity_px + view.disparity_offset_px, z = camera.fx_px * camera.baseline_m / d;
    const Eigen::Vector3d ray((disparities.u_px(column) - camera.cx_px) / camera.fx_px,
                              (disparities.v_px(row) - camera.cy_px) / camera.fy_px, 1);
    const double height_m = view.ground.heightOf_m(z * ray);
    if (height_m < kLow_m) continue;
    points.push_back({.direction_body = R_body_cam * ray,
                      .depth_m = z,
                      .noise_m = z * kSurfaceSigma_px * (1 << disparities.level) / d,
                      .height_m = height_m});
  }
  return points;
}

FaceInformation measureFaces(const LevelDisparities& disparities, const Outline& outline,
                             std::span<const SurfacePoint> surface, const ObjectView& view,
                             const StereoCamera& camera) {
  return FaceMeasurement(disparities, outline, surface, view, camera)();
}

FaceInformation measureFaces(const Sight& seen, std::span<const SurfacePoint> surface, const ObjectView& view,
                             const StereoCamera& camera) {
  const auto by = [&](const Outline& outline) {
    return measureFaces(seen.disparities, outline, surface, view, camera);
  };
  if (!seen.labelled) return by(seen.outline);
  if (view.small) return by(*seen.labelled);
  FaceInformation both;
  both.add(by(seen.outline), 0.5);
  both.add(by(*seen.labelled), 0.5);
  return both;
}

}  // namespace motorcade
