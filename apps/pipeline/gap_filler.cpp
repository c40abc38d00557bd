#include "apps/pipeline/gap_filler.hpp"

#include <algorithm>
#include <utility>

namespace motorcade {
namespace {

/// Longest time over which a motion is extrapolated.
constexpr double kMaxPrediction_s = 1.0;

}  // namespace

void GapFiller::Trail::add(const Moment& moment) { before = std::exchange(last, moment); }

/// Extrapolates at constant velocity from the last two moments, up to a second before and after them.
SE3 GapFiller::Trail::at(Timestamp stamp) const {
  if (!last) return SE3();
  if (!before || last->stamp <= before->stamp) return last->T_world_cam;
  const SE3 motion = before->T_world_cam.inverse() * last->T_world_cam;
  const double step_s = secondsBetween(before->stamp, last->stamp);
  const double factor =
      std::clamp(secondsBetween(last->stamp, stamp), -step_s - kMaxPrediction_s, kMaxPrediction_s) / step_s;
  return (last->T_world_cam * scaledMotion(motion, factor)).normalized();
}

SE3 GapFiller::predict(Timestamp stamp) const { return online_.at(stamp); }

std::vector<FrameEstimate> GapFiller::fill(const std::vector<MissedFrame>& frames) {
  std::vector<FrameEstimate> estimates;
  for (const MissedFrame& missed : frames) {
    FrameEstimate estimate;
    estimate.head = missed.head;
    estimate.head.segment = segment_;
    estimate.T_world_cam = predict(missed.head.stamp);
    missing_.push_back(estimate);
    estimates.push_back(std::move(estimate));
  }
  return estimates;
}

void GapFiller::published(const FrameEstimate& online, bool seen_by_backend) {
  online_.add({online.head.stamp, online.T_world_cam});
  if (!first_.before) first_.add({online.head.stamp, online.T_world_cam});
  segment_ = online.head.segment;
  if (!seen_by_backend) missing_.push_back(online);
}

std::vector<FrameEstimate> GapFiller::completed(const std::vector<FrameEstimate>& finals) {
  std::vector<FrameEstimate> all;
  for (const FrameEstimate& estimate : finals) {
    const Trail gap =
        final_.last ? Trail{.before = final_.last, .last = Moment{estimate.head.stamp, estimate.T_world_cam}} : first_;
    for (; !missing_.empty() && missing_.front().head.frame < estimate.head.frame; missing_.pop_front()) {
      all.push_back(missing_.front());
      all.back().T_world_cam = gap.at(all.back().head.stamp);
    }
    final_.add({estimate.head.stamp, estimate.T_world_cam});
    all.push_back(estimate);
  }
  return all;
}

std::vector<FrameEstimate> GapFiller::rest() {
  std::vector<FrameEstimate> all;
  for (; !missing_.empty(); missing_.pop_front()) {
    all.push_back(missing_.front());
    if (final_.last) all.back().T_world_cam = final_.at(all.back().head.stamp);
  }
  return all;
}

}  // namespace motorcade
