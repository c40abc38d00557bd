#include "frontend/scene_flow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/robust_loss.hpp"

namespace motorcade {
namespace {

/// A sighting with the relation of its camera to the newest one.
struct Observation {
  Eigen::Vector3d uvd_px;
  Eigen::Vector3d variance_px2;
  const CameraTrail::Relation* relation;
};

struct Window {
  std::array<Observation, PointTrack::kCapacity> observations;
  int size = 0;
  auto begin() const { return observations.begin(); }
  auto end() const { return observations.begin() + size; }
};

Window collect(const PointTrack& track, const CameraTrail& trail, double pose_jitter_px, int observations) {
  Window window;
  const double jitter2 = pose_jitter_px * pose_jitter_px;
  for (int i = std::max(0, track.count - observations); i < track.count; ++i) {
    const auto& s = track.sightings[static_cast<std::size_t>(i)];
    const auto* relation = trail.find(s.step);
    if (!relation) continue;
    const Eigen::Array3d variance = s.sigma_px.cast<double>().array().square() + jitter2;
    window.observations[static_cast<std::size_t>(window.size++)] = {s.uvd_px.cast<double>(), variance, relation};
  }
  return window;
}

/// One observation linearised at a position in the frame of now.
struct Linearized {
  Eigen::Matrix3d JtWJ;
  Eigen::Vector3d JtWr;
  double cost;  // robust, as a chi-square value: residuals in the linear part of the loss count by it
};

/// `wander_m` is the standard deviation by which the point may be off the model's position at that time.
std::optional<Linearized> linearize(const StereoCamera& camera, const Observation& o, const Eigen::Vector3d& p_now, double wander_m,
                                    double huber_sigmas) {
  const Eigen::Vector3d p_then = o.relation->T_then_now * p_now;
  const auto uvd = camera.project(p_then);
  if (!uvd) return std::nullopt;
  const Eigen::Matrix3d J = camera.projectionJacobian(p_then) * o.relation->T_then_now.rotation();
  Eigen::Matrix3d S = wander_m * wander_m * J * J.transpose();
  S.diagonal() += o.variance_px2;
  const Eigen::Matrix3d W = S.inverse();
  const Eigen::Vector3d r = o.uvd_px - *uvd;
  const double norm = std::sqrt(r.dot(W * r));
  const Eigen::Matrix3d JtW = robustWeight(RobustLoss::kHuber, norm, huber_sigmas) * J.transpose() * W;
  return Linearized{JtW * J, JtW * r, 2 * robustCost(RobustLoss::kHuber, norm, huber_sigmas)};
}

}  // namespace

std::optional<SceneFlowEstimator::StaticFit> SceneFlowEstimator::fitStatic(const PointTrack& track, const CameraTrail& trail) const {
  const Window window = collect(track, trail, params_.pose_jitter_px, params_.max_observations);
  if (window.size == 0) return std::nullopt;
  Eigen::Vector3d p = camera_.triangulate(track.newest().uvd_px.cast<double>());
  for (int iteration = 0;; ++iteration) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double chi2 = 0;
    for (const auto& o : window) {
      const auto l = linearize(camera_, o, p, 0, params_.huber_sigmas);
      if (!l) return std::nullopt;
      H += l->JtWJ;
      b += l->JtWr;
      chi2 += l->cost;
    }
    if (iteration == params_.iterations) return StaticFit{p, H.inverse(), chi2};
    p += H.inverse() * b;
    if (!p.allFinite() || p.z() < StereoCamera::kMinDepth_m) return std::nullopt;
  }
}

std::optional<SceneFlow> SceneFlowEstimator::fitMoving(const PointTrack& track, const CameraTrail& trail,
                                                       const std::optional<StaticFit>& at_rest) const {
  for (int n = std::min(params_.max_observations, track.count); n >= params_.min_observations; n = n > 5 ? (n + 1) / 2 : n - 1) {
    auto flow = fitMoving(track, trail, n);
    if (!flow) continue;
    flow->static_chi2 = at_rest ? at_rest->chi2 : std::numeric_limits<double>::infinity();
    return flow;
  }
  return std::nullopt;
}

std::optional<SceneFlow> SceneFlowEstimator::fitMoving(const PointTrack& track, const CameraTrail& trail, int observations) const {
  const Window window = collect(track, trail, params_.pose_jitter_px, observations);
  if (window.size < params_.min_observations) return std::nullopt;
  Eigen::Vector3d p = camera_.triangulate(track.newest().uvd_px.cast<double>());
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  const double prior_information = 1.0 / (params_.max_speed_mps * params_.max_speed_mps);
  for (int iteration = 0;; ++iteration) {
    Matrix6d H = Matrix6d::Zero();
    H.bottomRightCorner<3, 3>().diagonal().setConstant(prior_information);
    Vector6d b;
    b << Eigen::Vector3d::Zero(), -prior_information * v;
    double chi2 = 0;
    for (const auto& o : window) {
      const double dt_s = o.relation->dt_s;
      const auto l = linearize(camera_, o, p + dt_s * v, 0.5 * params_.acceleration_mps2 * dt_s * dt_s, params_.huber_sigmas);
      if (!l) return std::nullopt;
      H.topLeftCorner<3, 3>() += l->JtWJ;
      H.topRightCorner<3, 3>() += dt_s * l->JtWJ;
      H.bottomRightCorner<3, 3>() += dt_s * dt_s * l->JtWJ;
      b.head<3>() += l->JtWr;
      b.tail<3>() += dt_s * l->JtWr;
      chi2 += l->cost;
    }
    H.bottomLeftCorner<3, 3>() = H.topRightCorner<3, 3>().transpose();
    if (iteration == params_.iterations) {
      if (!(chi2 < params_.max_chi2_per_dof * (3.0 * window.size - 6.0))) return std::nullopt;
      return SceneFlow{.p_cam = p,
                       .velocity_mps = v,
                       .covariance = H.ldlt().solve(Matrix6d::Identity()),
                       .moving_chi2 = chi2,
                       .observations = window.size};
    }
    const Vector6d step = H.ldlt().solve(b);
    p += step.head<3>();
    v += step.tail<3>();
    if (!step.allFinite() || p.z() < StereoCamera::kMinDepth_m) return std::nullopt;
  }
}

}  // namespace motorcade
