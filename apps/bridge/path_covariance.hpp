#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Bounds the covariance of the camera's pose in the world, which the tracker does not give, by those of its motions;
/// of results that are seen from the vehicle, that of the vehicle's pose.
/// The path to a frame is a chain of n spans of ten frames, the first of them shorter; perturbations on the right of a
/// product of motions add up as
///   xi_now = Ad(T_before_now^-1) xi_before + xi_span
/// and whatever the spans' errors have to do with each other (they share landmarks and calibration),
///   Cov(xi_1 + ... + xi_n) <= n (Cov(xi_1) + ... + Cov(xi_n)).
/// It is as honest as the tracker's own covariances. Call it in frame order.
class PathCovariance {
 public:
  /// Of a perturbation (rho, phi) on the right of T_world_cam; zero in the first frame, which defines the world. Empty
  /// where the path to it has a gap over which nothing measured leads, as in all later segments.
  std::optional<Matrix6d> operator()(const Result& result);

 private:
  /// A chain of motions from the first frame on.
  struct Chain {
    Matrix6d sum = Matrix6d::Zero();  // of the spans' covariances, seen from the chain's end
    int spans = 0, steps = 0;         // steps: frames since the last span's end that count as one span more
  };
  struct Place {
    std::int64_t frame = -1, stamp_ns = 0;
    int segment = 0;
    SE3 T_world_cam{};
    std::optional<Chain> chain{};
  };
  /// Over the last ten frames, by the tracker's covariance of just that motion.
  std::optional<Chain> overSpan(const Result& result, const SE3& T_world_cam) const;
  /// Over the last frame alone, by the covariance of the velocity.
  std::optional<Chain> overStep(const Result& result, const SE3& T_world_cam) const;

  std::deque<Place> places_;  // back to ten frames ago
};

}  // namespace motorcade
