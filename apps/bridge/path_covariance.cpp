#include "apps/bridge/path_covariance.hpp"

#include <algorithm>

#include "apps/bridge/matrix_rows.hpp"
#include "apps/bridge/message_conversion.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kSpan_frames = 10;  // that `Result::motion_covariance` reaches back

/// A covariance of perturbations on the right of T_world_before, as perturbations on the right of T_world_now.
Matrix6d carried(const Matrix6d& covariance, const SE3& T_now_before) {
  const Matrix6d adjoint = T_now_before.adjoint();
  return adjoint * covariance * adjoint.transpose();
}

}  // namespace

std::optional<PathCovariance::Chain> PathCovariance::overSpan(const Result& result, const SE3& T_world_cam) const {
  if (!result.motion_covariance) return std::nullopt;
  const auto before = std::ranges::find_if(
      places_.rbegin(), places_.rend(), [&](const Place& place) { return place.frame <= result.frame - kSpan_frames; });
  if (before == places_.rend() || before->segment != result.segment || !before->chain) return std::nullopt;
  return Chain{.sum = carried(before->chain->sum, T_world_cam.inverse() * before->T_world_cam) +
                      matrixOf<6>(*result.motion_covariance),
               .spans = before->chain->spans + 1,
               .steps = 0};
}

std::optional<PathCovariance::Chain> PathCovariance::overStep(const Result& result, const SE3& T_world_cam) const {
  const Place& before = places_.back();
  const double dt_s = 1e-9 * static_cast<double>(result.stamp_ns - before.stamp_ns);
  if (before.segment != result.segment || !before.chain) return std::nullopt;
  Chain chain = *before.chain;
  chain.sum = carried(chain.sum, T_world_cam.inverse() * before.T_world_cam) +
              dt_s * dt_s * matrixOf<6>(result.velocity_covariance);
  chain.spans += chain.steps % kSpan_frames == 0 ? 1 : 0;
  ++chain.steps;
  return chain;
}

std::optional<Matrix6d> PathCovariance::operator()(const Result& result) {
  Place place{.frame = result.frame,
              .stamp_ns = result.stamp_ns,
              .segment = result.segment,
              .T_world_cam = transformOf(result.T_world_cam)};
  if (places_.empty()) place.chain = Chain();
  if (!place.chain) place.chain = overSpan(result, place.T_world_cam);
  if (!place.chain && !places_.empty()) place.chain = overStep(result, place.T_world_cam);
  places_.push_back(place);
  while (places_.size() > 1 && places_[1].frame <= result.frame - kSpan_frames) places_.pop_front();
  if (!place.chain) return std::nullopt;
  return std::max(1, place.chain->spans) * place.chain->sum;
}

}  // namespace motorcade
