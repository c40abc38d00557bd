#include "backend/joint/rig_offset.hpp"

#include <cmath>

#include "backend/factors/twist_factors.hpp"

namespace motorcade {
namespace {

constexpr double kHeldSigma_px = 1e-5;  // of a held offset: very long drives do not move it either
constexpr double kClearSigma_px = 0.1;  // of an observed offset, from which on it is looked at
/// Largest observed offset that may be distortion. It stands for half a pixel: while the offset is held, the landmarks
/// that show it best look noisy, count little, and hide a fifth of it.
constexpr double kDistortion_px = 0.4;
constexpr double kStep_px = 0.1;          // of the offset, after which landmarks are eliminated anew
constexpr int kFirstLook_frames = 8;      // after which the offset is looked at
constexpr int kCalibration_frames = 100;  // of the drive, in which the offset may be found

}  // namespace

RigOffset::RigOffset(IncrementalSolver& solver, double sigma_px)
    : solver_(solver), released_sigma_px_(sigma_px), variable_(solver.addVariable(SmallVector(SmallVector::Zero(1)))) {
  setPrior(kHeldSigma_px);
}

void RigOffset::setPrior(double sigma_px) {
  if (prior_) solver_.removeFactor(*prior_);
  prior_ = solver_.addFactor(std::make_unique<VectorPriorFactor>(variable_, SmallVector(SmallVector::Zero(1)),
                                                                 SmallVector(SmallVector::Constant(1, sigma_px))));
}

double RigOffset::px() const { return std::get<SmallVector>(solver_.estimate(variable_))[0]; }

double RigOffset::sigma_px() const {
  const auto covariance = solver_.jointCovariance(std::span(&variable_, 1));
  return covariance ? std::sqrt((*covariance)(0, 0)) : kHeldSigma_px;
}

/// Offset by the landmarks alone: the posterior without its prior.
std::optional<double> RigOffset::observed_px() const {
  const auto covariance = solver_.jointCovariance(std::span(&variable_, 1));
  if (!covariance) return std::nullopt;
  const double posterior = 1 / (*covariance)(0, 0), observed = posterior - 1 / (kHeldSigma_px * kHeldSigma_px);
  if (observed < 1 / (kClearSigma_px * kClearSigma_px)) return std::nullopt;
  return px() * posterior / observed;
}

bool RigOffset::release(FrameId newest) {
  if (!first_frame_.valid()) first_frame_ = newest;
  const std::int64_t age = newest.value - first_frame_.value;
  if (released_ || released_sigma_px_ <= 0 || age < kFirstLook_frames || isDecided(newest)) return false;
  const auto observed = observed_px();
  released_ = observed && std::abs(*observed) > kDistortion_px;
  if (released_) setPrior(released_sigma_px_);
  return released_;
}

bool RigOffset::hasMoved() const { return std::abs(px() - eliminated_px_) > kStep_px; }

bool RigOffset::isDecided(FrameId newest) const { return newest.value - first_frame_.value > kCalibration_frames; }

}  // namespace motorcade
