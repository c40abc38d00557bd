#include "backend/joint/rig_shake.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

constexpr double kLeastSigma_px = 1e-3;   // less than this cannot be told from none
constexpr double kPrior_frames = 2;       // that the first deviation counts for
constexpr double kKeep = 1 - 1.0 / 300;   // of what earlier frames told
constexpr double kMostSigmas = 3;         // of one frame: a pair may be damaged
constexpr std::size_t kLater_frames = 3;  // which have seen the landmarks of a frame, too, before it is learned from

}  // namespace

double RigShake::sigma_px() const {
  if (first_sigma_px_ <= 0) return 0;
  const double first = first_sigma_px_ * first_sigma_px_;
  const double variance_px2 = (kPrior_frames * first + weighted_sum_) / (kPrior_frames + weight_);
  return std::sqrt(std::max(variance_px2, kLeastSigma_px * kLeastSigma_px));
}

std::vector<double> RigShake::px(std::span<const FrameId> frames) const {
  std::vector<double> px;
  for (const FrameId frame : frames) {
    const auto known = px_.find(frame);
    px.push_back(known == px_.end() ? 0 : known->second);
  }
  return px;
}

/// Shakes without their mean have (n - 1) / n of their variance. A frame that was learned from keeps its shake: once it
/// is one of the oldest, few landmarks tell it, all with the same trend.
void RigShake::observe(std::span<const FrameId> frames, std::span<const FrameShake> shakes) {
  const double count = static_cast<double>(shakes.size()), with_mean = count > 1 ? count / (count - 1) : 1;
  for (std::size_t k = 0; k < shakes.size(); ++k) {
    if (learned_.valid() && frames[k] <= learned_) continue;
    px_[frames[k]] = shakes[k].px;
    if (k + kLater_frames >= shakes.size()) continue;
    learn({std::sqrt(with_mean) * shakes[k].px, with_mean * shakes[k].variance_px2});
    learned_ = frames[k];
  }
}

/// Learns the variance by the method of moments. The landmarks alone, without the prior, tell a shake s with the
/// variance v. The mean of s^2 - v is the variance of the shakes; its own variance is 2 (sigma^2 + v)^2.
void RigShake::learn(const FrameShake& shake) {
  const double sigma = sigma_px(), told = 1 / shake.variance_px2 - 1 / (sigma * sigma);
  if (!(told > 0)) return;
  const double px = shake.px / (shake.variance_px2 * told), variance_px2 = 1 / told;
  const double square = std::min(px * px, kMostSigmas * kMostSigmas * (sigma * sigma + variance_px2));
  const double first = first_sigma_px_ * first_sigma_px_, weight = std::pow(first / (first + variance_px2), 2);
  weighted_sum_ = kKeep * weighted_sum_ + weight * (square - variance_px2);
  weight_ = kKeep * weight_ + weight;
}

}  // namespace motorcade
