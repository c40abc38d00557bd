#include "frontend/geometry/stereo_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/instruction_set.hpp"
#include "frontend/geometry/cholesky.hpp"

#define HWY_TARGET_INCLUDE "frontend/geometry/stereo_pose.cpp"
#include <hwy/foreach_target.h>

#include "frontend/geometry/stereo_view.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Iterations with Huber's loss alone: only then is the pose good enough to leave out observations beyond the gate.
constexpr int kIterationsWithOutliers = 2;
constexpr int kMinObservations = 3;  // that determine the six degrees of freedom with some redundancy
constexpr double kMaxStep = 100;     // norm of an increment (m, rad) beyond which the fit diverges

HWY_INLINE Doubles3 load3(const std::array<PoseObservations::Block::Four, 3>& numbers) {
  return {load(numbers[0].data()), load(numbers[1].data()), load(numbers[2].data())};
}
HWY_INLINE SymmetricDoubles3x3 loadSymmetric(const std::array<PoseObservations::Block::Four, 6>& numbers) {
  return {load(numbers[0].data()), load(numbers[1].data()), load(numbers[2].data()),
          load(numbers[3].data()), load(numbers[4].data()), load(numbers[5].data())};
}

/// A pose, the same in all lanes.
struct PoseLanes {
  explicit PoseLanes(const SE3& T) : R(allDoubles(T.rotation())), t_m(allDoubles(T.translation())) {}
  Doubles3x3 R;
  Doubles3 t_m;
};

/// Residuals of four observations, their Jacobians with respect to the point, and the weights S^-1.
struct LinearizedBlock {
  StereoViews view;
  Doubles3 residual_px, weighted_residual;
  SymmetricDoubles3x3 information;
  /// Infinite where a point is so far away that rounding leaves no covariance.
  HWY_INLINE Doubles chi2() const {
    const Doubles sum = dot(residual_px, weighted_residual);
    return choose(sum >= 0.0, sum, kInfinity);
  }
};

HWY_INLINE LinearizedBlock linearize(const StereoCamera& camera, const PoseObservations::Block& o,
                                     const PoseLanes& T_cam_ref) {
  LinearizedBlock l;
  l.view = viewPoints(camera, T_cam_ref.R, T_cam_ref.t_m, load3(o.p_ref));
  const Doubles3x3& J = l.view.J;
  const SymmetricDoubles3x3 covariance_ref = loadSymmetric(o.covariance_ref);
  const Doubles3 variance_px2 = load3(o.variance_px2);
  SymmetricDoubles3x3 S =
      symmetricTimesTranspose({covariance_ref * J.x, covariance_ref * J.y, covariance_ref * J.z}, J);
  S.xx += variance_px2.x, S.yy += variance_px2.y, S.zz += variance_px2.z;
  l.information = inverse(S);
  l.residual_px = load3(o.uvd_px) - l.view.uvd_px;
  l.weighted_residual = l.information * l.residual_px;
  return l;
}

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double inlier_chi2 = 0;
  int inliers = 0;
};

/// The same in lanes, in blocks of the perturbation's translation (t) and rotation (r).
struct LaneEquations {
  SymmetricDoubles3x3 H_tt{}, H_rr{};
  Doubles3x3 H_tr{};
  Doubles3 b_t{}, b_r{};
  Doubles chi2{}, inliers{};

  HWY_INLINE void add(const PoseObservations::Block& o, const LinearizedBlock& l, double gate, double huber_sigmas) {
    const Doubles known_px = l.chi2();
    const auto is_in = known_px < gate;
    const Doubles counts = choose(is_in, load(o.count.data()) * l.view.ahead, 0.0),
                  chi2_px = choose(is_in, known_px, 0.0);
    // What is out may be infinite, and infinite times 0 is no number.
    const auto orNone = [&](const Doubles& value) HWY_ATTR { return choose(is_in, value, 0.0); };
    const SymmetricDoubles3x3 information{.xx = orNone(l.information.xx),
                                          .xy = orNone(l.information.xy),
                                          .xz = orNone(l.information.xz),
                                          .yy = orNone(l.information.yy),
                                          .yz = orNone(l.information.yz),
                                          .zz = orNone(l.information.zz)};
    const Doubles3 weighted_residual{orNone(l.weighted_residual.x), orNone(l.weighted_residual.y),
                                     orNone(l.weighted_residual.z)};
    const Doubles weight = huberLoss(chi2_px, huber_sigmas).weight * counts;
    const Doubles3x3& J_t = l.view.J;
    // The rows of -J_t hat(p_ref).
    const Doubles3 p_ref = load3(o.p_ref);
    const Doubles3x3 J_r{cross(p_ref, J_t.x), cross(p_ref, J_t.y), cross(p_ref, J_t.z)};
    const Doubles3x3 W_t = weight * (information * J_t), W_r = weight * (information * J_r);
    const Doubles3 r = weight * weighted_residual;
    H_tt += symmetricTransposeTimes(J_t, W_t);
    H_rr += symmetricTransposeTimes(J_r, W_r);
    H_tr += transposeTimes(J_t, W_r);
    b_t += transposeTimes(J_t, r);
    b_r += transposeTimes(J_r, r);
    chi2 += counts * weight * chi2_px;
    inliers += counts;
  }
  NormalEquations sum() const {
    NormalEquations n;
    const Eigen::Matrix3d tr = total(H_tr);
    n.H << total(H_tt), tr, tr.transpose(), total(H_rr);
    n.b << total(b_t), total(b_r);
    n.inlier_chi2 = total(chi2);
    n.inliers = static_cast<int>(total(inliers));
    return n;
  }
};

void add(NormalEquations& n, const PosePrior& prior, const SE3& T) {
  const Vector6d e = (prior.mean.inverse() * T).log();
  const Matrix6d Jr = rightJacobianInverseSE3(e);
  n.H.noalias() += Jr.transpose() * prior.information * Jr;
  n.b.noalias() -= Jr.transpose() * prior.information * e;
}

NormalEquations accumulate(const StereoCamera& camera, const PoseObservations& observations, const SE3& T,
                           const PoseFitParams& params, double gate, const PosePrior* prior) {
  const PoseLanes pose(T);
  LaneEquations lanes;
  for (const auto& o : observations.blocks()) lanes.add(o, linearize(camera, o, pose), gate, params.huber_sigmas);
  NormalEquations n = lanes.sum();
  if (prior) add(n, *prior, T);
  return n;
}

}  // namespace

std::optional<PoseFit> fit(const StereoCamera& camera, const PoseObservations& observations,
                           const SE3& initial_T_cam_ref, const PoseFitParams& params, const PosePrior* prior) {
  SE3 T = initial_T_cam_ref;
  NormalEquations n;
  for (int iteration = 0; iteration < params.max_iterations; ++iteration) {
    const double gate = iteration < kIterationsWithOutliers ? kInfinity : params.outlier_chi2;
    n = accumulate(camera, observations, T, params, gate, prior);
    if (!prior && n.inliers < kMinObservations) return std::nullopt;
    const Cholesky<6> solver(n.H);
    if (!solver.positive()) return std::nullopt;
    const Vector6d step = solver.solve(n.b);
    if (!step.allFinite() || step.norm() > kMaxStep) return std::nullopt;
    T = T * SE3::exp(step);
    if (iteration >= kIterationsWithOutliers && step.norm() < params.min_step) break;
  }
  PoseFit result{.T_cam_ref = T.normalized(), .covariance = Cholesky<6>(n.H).inverse()};
  if (n.inliers >= kMinObservations) result.inlier_chi2_per_dof = n.inlier_chi2 / (3.0 * n.inliers - 6.0);
  return result;
}

std::vector<double> chi2Of(const StereoCamera& camera, const PoseObservations& observations, const SE3& T_cam_ref) {
  const PoseLanes pose(T_cam_ref);
  std::vector<double> chi2;
  chi2.reserve(observations.blocks().size() * kDoubleLanes);
  for (const auto& o : observations.blocks()) {
    const LinearizedBlock l = linearize(camera, o, pose);
    const Doubles all = l.chi2();
    for (int lane = 0; lane < static_cast<int>(kDoubleLanes); ++lane)
      chi2.push_back(l.view.ahead[lane] > 0 ? all[lane] : kInfinity);
  }
  chi2.resize(observations.size());
  return chi2;
}

double score(const StereoCamera& camera, const PoseObservations& observations, const SE3& T_cam_ref,
             const PoseScoring& scoring, double bound) {
  const PoseLanes pose(T_cam_ref);
  const Doubles most = scoring.max_chi2;
  double sum = 0;
  std::size_t next = 0;
  for (const auto& o : observations.blocks()) {
    const LinearizedBlock l = linearize(camera, o, pose);
    const Doubles chi2 = l.chi2(), counted = choose((l.view.ahead > 0.0) & (chi2 < most), chi2, most);
    const std::size_t end = std::min(next + kDoubleLanes, observations.size());
    for (int lane = 0; next < end; ++lane, ++next) sum += scoring.weights[next] * counted[lane];
    if (sum >= bound) break;  // it only grows
  }
  return sum;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(fit);
MOTORCADE_EXPORT(chi2Of);
MOTORCADE_EXPORT(score);

PoseObservations::PoseObservations(std::span<const PoseObservation> observations) : size_(observations.size()) {
  constexpr std::size_t kLanes = std::tuple_size_v<Block::Four>;
  blocks_.resize((size_ + kLanes - 1) / kLanes);
  for (std::size_t i = 0; i < blocks_.size() * kLanes; ++i) {
    Block& block = blocks_[i / kLanes];
    const std::size_t lane = i % kLanes;
    const PoseObservation& o = observations[i < size_ ? i : i - lane];
    for (int row = 0, entry = 0; row < 3; ++row) {
      block.p_ref[row][lane] = o.p_ref[row];
      block.uvd_px[row][lane] = o.uvd_px[row];
      block.variance_px2[row][lane] = o.sigma_px[row] * o.sigma_px[row];
      for (int column = row; column < 3; ++column) block.covariance_ref[entry++][lane] = o.covariance_ref(row, column);
    }
    block.count[lane] = i < size_ ? 1 : 0;
  }
}

std::optional<PoseFit> fitPose(const StereoCamera& camera, const PoseObservations& observations,
                               const SE3& initial_T_cam_ref, const PoseFitParams& params, const PosePrior* prior) {
  return MOTORCADE_KERNEL(fit)(camera, observations, initial_T_cam_ref, params, prior);
}

std::vector<double> poseChi2(const StereoCamera& camera, const PoseObservations& observations, const SE3& T_cam_ref) {
  return MOTORCADE_KERNEL(chi2Of)(camera, observations, T_cam_ref);
}

double poseScore(const StereoCamera& camera, const PoseObservations& observations, const SE3& T_cam_ref,
                 const PoseScoring& scoring, double bound) {
  return MOTORCADE_KERNEL(score)(camera, observations, T_cam_ref, scoring, bound);
}

}  // namespace motorcade
#endif
