#include "frontend/motion/scene_flow.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "core/instruction_set.hpp"
#include "frontend/geometry/cholesky.hpp"

#define HWY_TARGET_INCLUDE "frontend/motion/scene_flow.cpp"
#include <hwy/foreach_target.h>

#include "frontend/geometry/stereo_view.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr double kConverged_chi2 = 1e-2;  // a step that gains less is the last
constexpr double kMaxChi2PerDof = 6;      // of the moving fit: above it the track is no single rigid point
constexpr int kShortWindow = 5;           // observations: longer windows that do not fit are halved, others lose one

int shorterWindow(int observations) { return observations > kShortWindow ? (observations + 1) / 2 : observations - 1; }

/// Four observations with the relation of their cameras to the newest one. Where there are fewer, the first one fills
/// up, without weight.
struct Observations {
  Doubles3x3 R_then_now;
  Doubles3 t_then_now_m;
  Doubles dt_s;
  Doubles3 uvd_px, variance_px2;
  Doubles count;  // 1 or 0
};

struct TrackWindow {
  static constexpr std::size_t kBlocks = (PointTrack::kCapacity + kDoubleLanes - 1) / kDoubleLanes;
  std::array<Observations, kBlocks> observations;  // only as many as `size` needs are filled
  int size = 0;

  std::span<const Observations> blocks() const {
    return {observations.begin(), (static_cast<std::size_t>(size) + kDoubleLanes - 1) / kDoubleLanes};
  }
  void add(const PointObservation& observation, const CameraTrail::Relation& relation, double jitter_px2) {
    const std::size_t lane = static_cast<std::size_t>(size) % kDoubleLanes;
    Observations& o = observations[static_cast<std::size_t>(size) / kDoubleLanes];
    set(o, lane, observation, relation, jitter_px2);
    if (lane == 0) o.count = Doubles{};
    o.count.set(static_cast<int>(lane), 1);
    ++size;
  }
  /// To be called after the last observation.
  void fillUnusedLanes() {
    const std::size_t used = static_cast<std::size_t>(size) % kDoubleLanes;
    if (used == 0) return;
    Observations& o = observations[static_cast<std::size_t>(size) / kDoubleLanes];
    for (std::size_t unused = used; unused < kDoubleLanes; ++unused) copyFirst(o, static_cast<int>(unused));
  }

 private:
  static void set(Observations& o, std::size_t lane, const PointObservation& observation,
                  const CameraTrail::Relation& relation, double jitter_px2) {
    const Eigen::Matrix3d& R = relation.T_then_now.rotation();
    setLane(o.R_then_now.x, lane, R.row(0));
    setLane(o.R_then_now.y, lane, R.row(1));
    setLane(o.R_then_now.z, lane, R.row(2));
    setLane(o.t_then_now_m, lane, relation.T_then_now.translation());
    setLane(o.uvd_px, lane, observation.uvd_px.cast<double>());
    setLane(o.variance_px2, lane, observation.sigma_px.cast<double>().array().square() + jitter_px2);
    o.dt_s.set(static_cast<int>(lane), relation.dt_s);
  }
  static void copyFirst(Observations& o, int lane) {
    for (Doubles3* v : {&o.R_then_now.x, &o.R_then_now.y, &o.R_then_now.z, &o.t_then_now_m, &o.uvd_px, &o.variance_px2})
      v->x.set(lane, v->x[0]), v->y.set(lane, v->y[0]), v->z.set(lane, v->z[0]);
    o.dt_s.set(lane, o.dt_s[0]);
  }
};

TrackWindow collect(const PointTrack& track, const CameraTrail& trail, double pose_jitter_px, int observations) {
  TrackWindow window;
  for (int i = std::max(0, track.count - observations); i < track.count; ++i) {
    const auto& s = track.observations[i];
    if (const auto* relation = trail.find(s.step)) window.add(s, *relation, pose_jitter_px * pose_jitter_px);
  }
  window.fillUnusedLanes();
  return window;
}

/// Four observations linearized at positions in the frame of now.
struct LinearizedPoint {
  SymmetricDoubles3x3 JtWJ;
  Doubles3 JtWr;
  Doubles cost;  // robust, as a chi-square value: residuals in the linear part of the loss count by it
};

/// `W_J` and `W_r` are the Jacobian and the residual times the weights.
HWY_INLINE LinearizedPoint weigh(const Observations& o, const Doubles3x3& J, const Doubles3x3& W_J, const Doubles3& r,
                                 const Doubles3& W_r, double huber_sigmas) {
  const HuberLoss loss = huberLoss(dot(r, W_r), huber_sigmas);
  const Doubles weight = o.count * loss.weight;
  return {weight * symmetricTransposeTimes(J, W_J), weight * transposeTimes(J, W_r), o.count * loss.chi2};
}

LinearizedPoint linearizeAtRest(const Observations& o, const StereoViews& view, double huber_sigmas) {
  const Doubles one = 1.0;
  const Doubles3 W{one / o.variance_px2.x, one / o.variance_px2.y, one / o.variance_px2.z}, r = o.uvd_px - view.uvd_px;
  return weigh(o, view.J, scaledRows(W, view.J), r, scaledRows(W, r), huber_sigmas);
}

/// `wander_m` is the standard deviation by which the points may be off the model's positions at their times.
LinearizedPoint linearizeMoving(const Observations& o, const StereoViews& view, const Doubles& wander_m,
                                double huber_sigmas) {
  SymmetricDoubles3x3 S = (wander_m * wander_m) * symmetricTimesTranspose(view.J, view.J);
  S.xx += o.variance_px2.x, S.yy += o.variance_px2.y, S.zz += o.variance_px2.z;
  const SymmetricDoubles3x3 W = inverse(S);
  const Doubles3 r = o.uvd_px - view.uvd_px;
  return weigh(o, view.J, W * view.J, r, W * r, huber_sigmas);
}

bool allAhead(const StereoViews& view) { return total(view.ahead) == kDoubleLanes; }

/// Position and velocity of a point, in the frame of now.
struct MovingPoint {
  Eigen::Vector3d p_cam, velocity_mps;
};

/// Normal equations of (p, v).
struct MovingEquations {
  Matrix6d H;
  Vector6d b;
  double cost;
};

/// Empty where the point lies behind a camera.
std::optional<MovingEquations> linearizeMoving(const StereoCamera& camera, const TrackWindow& window,
                                               const MovingPoint& point, const SceneFlowEstimator::Params& params) {
  SymmetricDoubles3x3 H_pp{}, H_pv{}, H_vv{};
  Doubles3 b_p{}, b_v{};
  Doubles cost{};
  for (const auto& o : window.blocks()) {
    const StereoViews view = viewPoints(camera, o.R_then_now, o.t_then_now_m,
                                        allDoubles(point.p_cam) + o.dt_s * allDoubles(point.velocity_mps));
    if (!allAhead(view)) return std::nullopt;
    const LinearizedPoint l =
        linearizeMoving(o, view, (0.5 * params.acceleration_mps2) * o.dt_s * o.dt_s, params.huber_sigmas);
    H_pp += l.JtWJ, H_pv += o.dt_s * l.JtWJ, H_vv += (o.dt_s * o.dt_s) * l.JtWJ;
    b_p += l.JtWr, b_v += o.dt_s * l.JtWr;
    cost += l.cost;
  }
  const double prior_information = 1.0 / (params.max_speed_mps * params.max_speed_mps);
  MovingEquations n;
  const Eigen::Matrix3d cross = total(H_pv);
  n.H << total(H_pp), cross, cross, total(H_vv);
  n.H.diagonal().tail<3>().array() += prior_information;
  n.b << total(b_p), total(b_v) - prior_information * point.velocity_mps;
  n.cost = total(cost);
  return n;
}

std::optional<SceneFlowEstimator::StaticFit> fitStatic(const StereoCamera& camera, const TrackWindow& window,
                                                       const Eigen::Vector3d& start,
                                                       const SceneFlowEstimator::Params& params) {
  if (window.size == 0) return std::nullopt;
  Eigen::Vector3d p = start;
  for (int iteration = 0;; ++iteration) {
    LinearizedPoint sum{};
    for (const auto& o : window.blocks()) {
      const StereoViews view = viewPoints(camera, o.R_then_now, o.t_then_now_m, allDoubles(p));
      if (!allAhead(view)) return std::nullopt;
      const LinearizedPoint l = linearizeAtRest(o, view, params.huber_sigmas);
      sum.JtWJ += l.JtWJ, sum.JtWr += l.JtWr, sum.cost += l.cost;
    }
    const Cholesky<3> H(total(sum.JtWJ));
    if (!H.positive()) return std::nullopt;
    const Eigen::Vector3d b = total(sum.JtWr), step = H.solve(b);
    const double gain = b.dot(step);
    const bool converged = gain < kConverged_chi2;
    if (converged) return SceneFlowEstimator::StaticFit{p + step, H.inverse(), total(sum.cost) - gain};
    if (iteration == params.iterations) return SceneFlowEstimator::StaticFit{p, H.inverse(), total(sum.cost)};
    p += step;
    if (!p.allFinite() || p.z() < StereoCamera::kMinDepth_m) return std::nullopt;
  }
}

std::optional<SceneFlow> fitMoving(const StereoCamera& camera, const TrackWindow& window, const Eigen::Vector3d& start,
                                   const SceneFlowEstimator::Params& params) {
  if (window.size < params.min_observations) return std::nullopt;
  MovingPoint point{start, Eigen::Vector3d::Zero()};
  for (int iteration = 0;; ++iteration) {
    const auto normal = linearizeMoving(camera, window, point, params);
    if (!normal) return std::nullopt;
    const Cholesky<6> H(normal->H);
    if (!H.positive()) return std::nullopt;
    const Vector6d step = H.solve(normal->b);
    const double gain = normal->b.dot(step);
    const bool converged = gain < kConverged_chi2, last = converged || iteration == params.iterations;
    const double chi2 = normal->cost - (converged ? gain : 0);
    if (last && !(chi2 < kMaxChi2PerDof * (3.0 * window.size - 6.0))) return std::nullopt;
    if (converged || !last) point.p_cam += step.head<3>(), point.velocity_mps += step.tail<3>();
    if (last)
      return SceneFlow{.p_cam = point.p_cam,
                       .velocity_mps = point.velocity_mps,
                       .covariance = H.inverse(),
                       .moving_chi2 = chi2,
                       .observations = window.size};
    if (!step.allFinite() || point.p_cam.z() < StereoCamera::kMinDepth_m) return std::nullopt;
  }
}

}  // namespace

SceneFlowEstimator::Fits fitBoth(const SceneFlowEstimator::Params& params, const StereoCamera& camera,
                                 const PointTrack& track, const CameraTrail& trail) {
  const Eigen::Vector3d start = camera.triangulate(track.newest().uvd_px.cast<double>());
  int n = std::min(params.max_observations, track.count);
  TrackWindow window = collect(track, trail, params.pose_jitter_px, n);
  SceneFlowEstimator::Fits fits{.at_rest = fitStatic(camera, window, start, params),
                                .moving = fitMoving(camera, window, start, params)};
  while (!fits.moving && (n = shorterWindow(n)) >= params.min_observations) {
    window = collect(track, trail, params.pose_jitter_px, n);
    fits.moving = fitMoving(camera, window, start, params);
  }
  if (fits.moving)
    fits.moving->static_chi2 = fits.at_rest ? fits.at_rest->chi2 : std::numeric_limits<double>::infinity();
  return fits;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(fitBoth);

SceneFlowEstimator::Fits SceneFlowEstimator::fit(const PointTrack& track, const CameraTrail& trail) const {
  return MOTORCADE_KERNEL(fitBoth)(params_, camera_, track, trail);
}

std::vector<Parameter> parametersOf(SceneFlowEstimator::Params& params) {
  return {numberParameter("max_observations", params.max_observations, {5, PointTrack::kCapacity},
                          "more frames tell slow movers better, fewer follow maneuvers"),
          numberParameter("min_observations", params.min_observations, {2, 5},
                          "fewer see movers earlier, more see them surely"),
          numberParameter("max_speed_mps", params.max_speed_mps, {10, 200},
                          "standard deviation of a point's speed before it is measured")};
}

}  // namespace motorcade
#endif
