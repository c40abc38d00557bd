#include "backend/joint/landmark.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "backend/joint/landmark.cpp"
#include <hwy/foreach_target.h>

#include "backend/joint/row_products.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kPoseNumbers = 12;

/// Four vectors.
struct Lanes3 {
  Vec x, y, z;
};
HWY_INLINE Lanes3 operator*(const Lanes3& a, const Lanes3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
HWY_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Four contiguous numbers of each of four views, the same number of all views in a vector.
template <class Place>
HWY_INLINE std::array<Vec, 4> loadFrom(const LandmarkView* const (&views)[kLanes], const Place& place) {
  std::array<Vec, 4> numbers{load(place(*views[0])), load(place(*views[1])), load(place(*views[2])),
                             load(place(*views[3]))};
  transpose(numbers[0], numbers[1], numbers[2], numbers[3]);
  return numbers;
}

/// Up to four views with their poses; lanes without one repeat the last.
class ViewLanes {
 public:
  HWY_INLINE ViewLanes(std::span<const LandmarkView> views, const double* poses) {
    const LandmarkView* of[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) of[i] = &views[std::min(i, views.size() - 1)];
    for (int k = 0; k < kPoseNumbers; k += 4) {
      const auto numbers =
          loadFrom(of, [&](const LandmarkView& v) HWY_ATTR { return poses + std::size_t(kPoseNumbers) * v.frame + k; });
      for (int i = 0; i < 4; ++i) pose_[k + i] = numbers[i];
    }
    const auto lanes = [&](const auto& value)
                           HWY_ATTR { return four(value(*of[0]), value(*of[1]), value(*of[2]), value(*of[3])); };
    uvd_px = {lanes([](auto& v) HWY_ATTR { return v.uvd_px[0]; }), lanes([](auto& v) HWY_ATTR { return v.uvd_px[1]; }),
              lanes([](auto& v) HWY_ATTR { return v.uvd_px[2]; })};
    inverse_sigma = {lanes([](auto& v) HWY_ATTR { return v.inverse_sigma[0]; }),
                     lanes([](auto& v) HWY_ATTR { return v.inverse_sigma[1]; }),
                     lanes([](auto& v) HWY_ATTR { return v.inverse_sigma[2]; })};
  }

  HWY_INLINE Lanes3 rotated(const Eigen::Vector3d& v) const {
    return {(pose_[0] * v.x() + pose_[3] * v.y()) + pose_[6] * v.z(),
            (pose_[1] * v.x() + pose_[4] * v.y()) + pose_[7] * v.z(),
            (pose_[2] * v.x() + pose_[5] * v.y()) + pose_[8] * v.z()};
  }
  HWY_INLINE Lanes3 moved(const Eigen::Vector3d& p) const {
    const Lanes3 turned = rotated(p);
    return {turned.x + pose_[9], turned.y + pose_[10], turned.z + pose_[11]};
  }

  /// From the camera's axes to the body's.
  HWY_INLINE Lanes3 turnedBack(const Lanes3& v) const {
    return {(pose_[0] * v.x + pose_[1] * v.y) + pose_[2] * v.z, (pose_[3] * v.x + pose_[4] * v.y) + pose_[5] * v.z,
            (pose_[6] * v.x + pose_[7] * v.y) + pose_[8] * v.z};
  }

  Lanes3 uvd_px, inverse_sigma;

 private:
  Vec pose_[kPoseNumbers];  // the rotation column by column, and the translation
};

HWY_INLINE Vec rootWeights(const LandmarkNoise& noise, const Vec& squared_norm) {
  double norms[kLanes], weights[kLanes];
  HWY_NAMESPACE::store(norms, squareRoots(squared_norm));
  for (int i = 0; i < kLanes; ++i) weights[i] = robustWeight(noise.loss, norms[i], noise.loss_scale);
  return squareRoots(load(weights));
}

/// Where in a linear model four contiguous numbers are.
HWY_INLINE auto bRow(int row) {
  return [=](LinearView& linear) HWY_ATTR { return linear.B.data() + 4 * row; };
}
HWY_INLINE auto jRow(int row, int column = 0) {
  return [=](LinearView& linear) HWY_ATTR { return linear.J.data() + 8 * row + column; };
}

/// Four numbers of each of four models.
template <class Place>
HWY_INLINE void storeInto(std::array<Vec, 4> numbers, LinearView* linear, const Place& place) {
  transpose(numbers[0], numbers[1], numbers[2], numbers[3]);
  for (int i = 0; i < kLanes; ++i) HWY_NAMESPACE::store(place(linear[i]), numbers[i]);
}

/// How a number that changes with a point seen from the camera changes with steps of the frame's pose.
class PoseSteps {
 public:
  HWY_INLINE PoseSteps(const ViewLanes& view, FramePose pose, const Eigen::Vector3d& p_body, const Lanes3& p_cam)
      : view_(view),
        moves_camera_(pose == FramePose::kWorldCam),
        lever_(moves_camera_ ? view.turnedBack(p_cam) : view.rotated(p_body)) {}

  /// By the pose's origin, and by its turn about that.
  HWY_INLINE std::array<Lanes3, 2> operator()(const Lanes3& by_p_cam) const {
    if (!moves_camera_) return {by_p_cam, cross(lever_, by_p_cam)};
    const Lanes3 m = view_.turnedBack(by_p_cam), by_origin{-m.x, -m.y, -m.z};
    return {by_origin, cross(lever_, by_origin)};
  }

 private:
  const ViewLanes& view_;
  bool moves_camera_;
  Lanes3 lever_;  // from the pose's origin to the point, in the axes of its steps
};

/// A row of J: by the steps of the pose, and what is right of that.
HWY_INLINE void storeByPose(const std::array<Lanes3, 2>& by_steps, const std::array<Vec, 2>& rest, LinearView* linear,
                            int row) {
  const auto& [origin, turn] = by_steps;
  storeInto({origin.x, origin.y, origin.z, turn.x}, linear, jRow(row));
  storeInto({turn.y, turn.z, rest[0], rest[1]}, linear, jRow(row, 4));
}

/// V += B' B, g += B' r.
HWY_INLINE void addNormalEquations(std::span<const LinearView> views, Matrix4d& V, Vector4d& g) {
  Vec sum = load(g.data());
  for (const LinearView& l : views) {
    addOuterProducts(l.B, l.B, V);
    for (int k = 0; k < 3; ++k) sum += load(l.B.data() + 4 * k) * broadcast(l.J(k, 7));
  }
  store(g.data(), sum);
}

/// Up to four views in the lanes of vectors; what lanes without a view hold is not used. False where the landmark lies
/// behind a camera.
bool linearizeFour(std::span<const LandmarkView> views, LandmarkFit::Linearization& at, LinearView* linear) {
  const ViewLanes view(views, at.poses.data());
  const Lanes3 p = view.moved(at.p_body);
  const StereoCamera& camera = at.camera;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (p.z[static_cast<int>(i)] < StereoCamera::kMinDepth_m) return false;
  const Vec iz = 1 / p.z, x = p.x * iz, y = p.y * iz, fb = broadcast(camera.fx_px * camera.baseline_m);
  Lanes3 r{view.uvd_px.x - (camera.fx_px * x + camera.cx_px), view.uvd_px.y - (camera.fy_px * y + camera.cy_px),
           view.uvd_px.z - fb * iz + at.offset_px};
  r = r * view.inverse_sigma;
  const Vec squared_norm = (r.x * r.x + r.y * r.y) + r.z * r.z;
  const Vec root_weight = rootWeights(at.noise, squared_norm * broadcast(1 / at.variance));
  for (int i = 0; i < static_cast<int>(views.size()); ++i)
    at.squares += squared_norm[i] * root_weight[i] * root_weight[i];
  const Lanes3 whiten{root_weight * view.inverse_sigma.x, root_weight * view.inverse_sigma.y,
                      root_weight * view.inverse_sigma.z};
  // J = -whiten d(u, v, d) / d(p_cam) has the rows (ux, 0, uz), (0, vy, vz), (0, 0, dz).
  const Vec zero{}, ux = -camera.fx_px * (whiten.x * iz), uz = -ux * x, vy = -camera.fy_px * (whiten.y * iz),
                    vz = -vy * y, dz = fb * (whiten.z * iz) * iz;
  const Lanes3 d0 = view.rotated(at.G.col(0)), d1 = view.rotated(at.G.col(1)), d2 = view.rotated(at.G.col(2));
  storeInto({ux * d0.x + uz * d0.z, ux * d1.x + uz * d1.z, ux * d2.x + uz * d2.z, zero}, linear, bRow(0));
  storeInto({vy * d0.y + vz * d0.z, vy * d1.y + vz * d1.z, vy * d2.y + vz * d2.z, zero}, linear, bRow(1));
  storeInto({dz * d0.z, dz * d1.z, dz * d2.z, -whiten.z}, linear, bRow(2));
  const PoseSteps steps(view, at.pose, at.p_body, p);
  storeByPose(steps({ux, zero, uz}), {zero, root_weight * r.x}, linear, 0);
  storeByPose(steps({zero, vy, vz}), {zero, root_weight * r.y}, linear, 1);
  storeByPose(steps({zero, zero, dz}), {whiten.z, root_weight * r.z}, linear, 2);
  addNormalEquations(std::span(linear, views.size()), at.V, at.gradient);
  return true;
}

}  // namespace

bool linearize(std::span<const LandmarkView> views, LandmarkFit::Linearization& at, LinearView* linear) {
  for (std::size_t i = 0; i < views.size(); i += kLanes)
    if (!linearizeFour(views.subspan(i, std::min<std::size_t>(kLanes, views.size() - i)), at, linear + i)) return false;
  return true;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(linearize);

namespace {

constexpr double kLeastDisparity_px = 0.3;  // a landmark with less is at infinity
constexpr double kLeastSharedSigma_px = 1e-3;
constexpr int kMostSteps = 3;
constexpr int kPoint = 3;            // unknowns that the views of a landmark tell
constexpr double kFittedCost = 0.1;  // what a step would take off the squared residuals when a landmark is fitted

}  // namespace

double LandmarkNoise::meanSquare() const {
  constexpr double kOfCauchy = 0.3685;  // with the scale 1.5, from 3e5 samples
  return loss == RobustLoss::kNone ? 1 : kOfCauchy;
}

LandmarkFit::LandmarkFit(const StereoCamera& camera, const LandmarkNoise& noise, FramePose pose,
                         std::span<const SE3> T_cam_body, double offset_px)
    : camera_(camera), noise_(noise), pose_(pose), T_cam_body_(T_cam_body), offset_px_(offset_px) {
  poses_.reserve(HWY_NAMESPACE::kPoseNumbers * T_cam_body.size());
  for (const SE3& T : T_cam_body) {
    poses_.insert(poses_.end(), T.rotation().data(), T.rotation().data() + T.rotation().size());
    poses_.insert(poses_.end(), T.translation().begin(), T.translation().end());
  }
}

/// From an estimate until it moves no more; from the newest view, one step: what is left, the elimination takes into
/// account.
bool LandmarkFit::operator()(std::span<const LandmarkView> views, const std::optional<LandmarkEstimate>& before) {
  newest_frame_ = views.back().frame;
  variance_ = information_share_ = 1;
  int steps = kMostSteps;
  if (!before || !beginFrom(*before)) {
    landmark_ << views.back().uvd_px + Eigen::Vector3d(0, 0, offset_px_), 0;
    steps = 1;
  }
  for (;; --steps) {
    if (!linearize(views)) return false;
    if (steps == 0) return true;
    const Vector4d step = llt_.solve(gradient_);
    if (step.dot(gradient_) < kFittedCost) return true;
    landmark_ -= step;
  }
}

bool LandmarkFit::beginFrom(const LandmarkEstimate& before) {
  const auto uvd_px = camera_.project(T_cam_body_[newest_frame_] * before.p_body);
  if (!uvd_px) return false;
  landmark_ << *uvd_px, before.shared_error_px;
  return true;
}

std::optional<LandmarkEstimate> LandmarkFit::estimate() const {
  const Vector4d landmark = landmark_ - llt_.solve(gradient_);
  if (!(landmark[2] > kLeastDisparity_px)) return std::nullopt;
  return LandmarkEstimate{T_cam_body_[newest_frame_].inverse() * camera_.triangulate(landmark.head<3>()), landmark[3]};
}

std::optional<KnownLandmark> LandmarkFit::known() const {
  const Vector4d landmark = landmark_ - llt_.solve(gradient_);
  if (!(landmark[2] > kLeastDisparity_px)) return std::nullopt;
  const Matrix4d root = HWY_NAMESPACE::inverseTransposed(llt_.matrixL());
  return KnownLandmark{landmark, root * root.transpose()};
}

bool LandmarkFit::linearize(std::span<const LandmarkView> views) {
  if (!(landmark_[2] > kLeastDisparity_px)) return false;
  const SE3 T_body_cam = T_cam_body_[newest_frame_].inverse();
  const Eigen::Vector3d uvd_px = landmark_.head<3>();
  count_ = views.size();
  linear_.resize((count_ + HWY_NAMESPACE::kLanes - 1) / HWY_NAMESPACE::kLanes * HWY_NAMESPACE::kLanes);
  Linearization at{.camera = camera_,
                   .noise = noise_,
                   .pose = pose_,
                   .poses = poses_,
                   .offset_px = offset_px_ - landmark_[3],
                   .variance = variance_,
                   .p_body = T_body_cam * camera_.triangulate(uvd_px),
                   .G = T_body_cam.rotation() * camera_.triangulationJacobian(uvd_px)};
  if (!MOTORCADE_KERNEL(linearize)(views, at, linear_.data())) return false;
  V_ = at.V, gradient_ = at.gradient, squares_ = at.squares;
  if (noise_.variance_freedom > 0) weighByOwnVariance();
  addSharedError(views);
  llt_.compute(V_);
  return true;
}

/// The variance is the mean of its posterior's precision, inverted: (n + d) / (n + sum r'r).
void LandmarkFit::weighByOwnVariance() {
  const double prior = noise_.variance_freedom, freedom = prior + 3.0 * static_cast<double>(count_) - kPoint;
  variance_ = (prior + squares_ / noise_.meanSquare()) / freedom;
  information_share_ = freedom / (freedom + 2);
  const double weight = information_share_ / variance_, root_weight = std::sqrt(weight);
  V_ *= weight;
  gradient_ *= weight;
  for (LinearView& view : linear_) view.J *= root_weight, view.B *= root_weight;
}

void LandmarkFit::addSharedError(std::span<const LandmarkView> views) {
  double sigma_sum_px = 0;
  for (const LandmarkView& view : views) sigma_sum_px += 1 / view.inverse_sigma.z();
  const double own_sigma_px = std::sqrt(variance_) * sigma_sum_px / static_cast<double>(views.size());
  shared_sigma_px_ = std::max(
      std::hypot(noise_.shared_disparity_sigma_px, noise_.shared_disparity_share * own_sigma_px), kLeastSharedSigma_px);
  const double information = 1 / (shared_sigma_px_ * shared_sigma_px_);
  V_(3, 3) += information;
  gradient_[3] += information * landmark_[3];
}

}  // namespace motorcade
#endif
