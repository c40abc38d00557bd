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
  Eigen::Vector3d inverse_variance;
  const CameraTrail::Relation* relation;
};

struct Window {
  std::array<Observation, PointTrack::kCapacity> observations;
  int size = 0;
  auto begin() const { return observations.begin(); }
  auto end() const { return observations.begin() + size; }
};

Window collect(const PointTrack& track, const CameraTrail& trail, const SceneFlowEstimator::Params& params) {
  Window window;
  const double jitter2 = params.pose_jitter_px * params.pose_jitter_px;
  for (int i = std::max(0, track.count - params.max_observations); i < track.count; ++i) {
    const auto& s = track.sightings[static_cast<std::size_t>(i)];
    const auto* relation = trail.find(s.step);
    if (!relation) continue;
    const Eigen::Array3d variance = s.sigma_px.cast<double>().array().square() + jitter2;
    window.observations[static_cast<std::size_t>(window.size++)] = {s.uvd_px.cast<double>(), variance.inverse(), relation};
  }
  return window;
}

/// One observation linearised at a position in the frame of now.
struct Linearized {
  Eigen::Matrix3d JtWJ;
  Eigen::Vector3d JtWr;
  double chi2;
  double weight;
};

std::optional<Linearized> linearize(const StereoCamera& camera, const Observation& o, const Eigen::Vector3d& p_now, double huber_sigmas) {
  const Eigen::Vector3d p_then = o.relation->T_then_now * p_now;
  const auto uvd = camera.project(p_then);
  if (!uvd) return std::nullopt;
  const Eigen::Matrix3d J = camera.projectionJacobian(p_then) * o.relation->T_then_now.rotation();
  const Eigen::Vector3d r = o.uvd_px - *uvd;
  const double chi2 = r.cwiseAbs2().dot(o.inverse_variance);
  const double weight = robustWeight(RobustLoss::kHuber, std::sqrt(chi2), huber_sigmas);
  const Eigen::Matrix3d JtW = J.transpose() * (weight * o.inverse_variance).asDiagonal();
  return Linearized{JtW * J, JtW * r, chi2, weight};
}

/// Robust cost of a window under a motion, as a chi-square value: residuals in the linear part of the loss count by it.
double windowChi2(const StereoCamera& camera, const Window& window, const Eigen::Vector3d& p, const Eigen::Vector3d& v, double huber_sigmas) {
  double chi2 = 0;
  for (const auto& o : window) {
    const auto uvd = camera.project(o.relation->T_then_now * Eigen::Vector3d(p + o.relation->dt_s * v));
    if (!uvd) return std::numeric_limits<double>::infinity();
    const double squared = (o.uvd_px - *uvd).cwiseAbs2().dot(o.inverse_variance);
    chi2 += 2 * robustCost(RobustLoss::kHuber, std::sqrt(squared), huber_sigmas);
  }
  return chi2;
}

}  // namespace

std::optional<SceneFlowEstimator::StaticFit> SceneFlowEstimator::fitStatic(const PointTrack& track, const CameraTrail& trail) const {
  const Window window = collect(track, trail, params_);
  if (window.size == 0) return std::nullopt;
  Eigen::Vector3d p = camera_.triangulate(track.newest().uvd_px.cast<double>());
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (int iteration = 0; iteration < params_.iterations; ++iteration) {
    H.setZero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const auto& o : window) {
      const auto l = linearize(camera_, o, p, params_.huber_sigmas);
      if (!l) return std::nullopt;
      H += l->JtWJ;
      b += l->JtWr;
    }
    p += H.inverse() * b;
    if (!p.allFinite() || p.z() < StereoCamera::kMinDepth_m) return std::nullopt;
  }
  return StaticFit{p, H.inverse(), windowChi2(camera_, window, p, Eigen::Vector3d::Zero(), params_.huber_sigmas)};
}

std::optional<SceneFlow> SceneFlowEstimator::fitMoving(const PointTrack& track, const CameraTrail& trail, const StaticFit& at_rest) const {
  const Window window = collect(track, trail, params_);
  if (window.size < params_.min_observations) return std::nullopt;
  Eigen::Vector3d p = camera_.triangulate(track.newest().uvd_px.cast<double>());
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  const double prior_information = 1.0 / (params_.max_speed_mps * params_.max_speed_mps);
  Matrix6d H = Matrix6d::Zero();
  for (int iteration = 0; iteration < params_.iterations; ++iteration) {
    H.setZero();
    H.bottomRightCorner<3, 3>().diagonal().setConstant(prior_information);
    Vector6d b;
    b << Eigen::Vector3d::Zero(), -prior_information * v;
    for (const auto& o : window) {
      const double dt_s = o.relation->dt_s;
      const auto l = linearize(camera_, o, p + dt_s * v, params_.huber_sigmas);
      if (!l) return std::nullopt;
      H.topLeftCorner<3, 3>() += l->JtWJ;
      H.topRightCorner<3, 3>() += dt_s * l->JtWJ;
      H.bottomRightCorner<3, 3>() += dt_s * dt_s * l->JtWJ;
      b.head<3>() += l->JtWr;
      b.tail<3>() += dt_s * l->JtWr;
    }
    H.bottomLeftCorner<3, 3>() = H.topRightCorner<3, 3>().transpose();
    const Vector6d step = H.ldlt().solve(b);
    p += step.head<3>();
    v += step.tail<3>();
    if (!step.allFinite() || p.z() < StereoCamera::kMinDepth_m) return std::nullopt;
  }
  SceneFlow flow{.p_cam = p, .velocity_mps = v, .covariance = H.ldlt().solve(Matrix6d::Identity())};
  flow.static_chi2 = at_rest.chi2;
  flow.moving_chi2 = windowChi2(camera_, window, p, v, params_.huber_sigmas);
  flow.observations = window.size;
  if (!(flow.moving_chi2 < params_.max_chi2_per_dof * (3.0 * window.size - 6.0))) return std::nullopt;
  return flow;
}

}  // namespace motorcade
