#include "apps/run/run_watch.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "apps/console/log.hpp"

namespace motorcade {

bool InputWatch::admits(const StereoFrame& pair) {
  if (!refused_) tell(watch_.observe(pair));
  return !refused_;
}

/// Logs the findings. "points" (the whole drive shows none) refuses nothing: the run itself counts the frames it
/// followed.
void InputWatch::tell(const std::vector<RigFinding>& found) {
  for (const RigFinding& each : found) {
    found_.push_back(each);
    if (each.finding.worthless && each.finding.name != "points" && !force_) {
      refused_ = true;
      logError(fmt::format("{}; {}--force goes on", each.text(),
                           each.last_good ? "what is written of frames before is good, " : ""));
    } else {
      logWarning(each.text());
    }
  }
}

namespace {

/// Continues the sentence "most of them, 12, ".
const char* sentenceOn(FrameCause cause) {
  switch (cause) {
    case FrameCause::kNothingFound:
      return "show nothing of the frame before: they are dark, blurred, without texture or frozen, or the images of a "
             "pair do not belong together";
    case FrameCause::kUnlinked:
      return "show points, but not how the camera moved";
    case FrameCause::kFailed:
      return "could not be worked on";
    case FrameCause::kUnusable:
      return "cannot be used";
    case FrameCause::kOutOfOrder:
      return "have a time that does not follow that of the frame before: look at times.txt";
    case FrameCause::kTooLate:
      return "did not come, or not in time";
    default:
      return "were not followed";
  }
}

constexpr double kMostPeriod_s = 2, kLeastPeriod_s = 5e-4;
constexpr double kMostSpeed_mps = 75;  // 270 km/h
constexpr int kPersistent_frames = 5;

}  // namespace

void FollowedFrames::observe(const PipelineResult& result) {
  if (result.online.head.status == FrameStatus::kGood) ++count_;
  std::string& first = first_problems_[static_cast<std::size_t>(result.online.head.cause)];
  if (first.empty()) first = result.problem;
}

bool FollowedFrames::none(const PipelineSummary& summary) const {
  return count_ == 0 ? summary.received > 0 : count_ == 1 && summary.received > 1;
}

std::string FollowedFrames::whyNone(const PipelineSummary& summary) const {
  const auto most = std::ranges::max_element(summary.causes.begin() + 1, summary.causes.end());
  const auto cause = static_cast<std::size_t>(most - summary.causes.begin());
  const std::string& problem = first_problems_[cause];
  return fmt::format("no motion was measured in {} frames; most of them, {}, {}{}{}", summary.received, *most,
                     sentenceOn(static_cast<FrameCause>(cause)), problem.empty() ? "" : ": ", problem);
}

bool Plausibility::Persistent::observe(bool holds) {
  frames_ = holds ? frames_ + 1 : 0;
  if (told_ || frames_ < kPersistent_frames) return false;
  return told_ = true;
}

std::optional<std::string> Plausibility::observe(const FrameEstimate& online) {
  const auto before = std::exchange(before_, Seen{online.head.stamp, online.head.status, online.T_world_cam});
  if (!before) return std::nullopt;
  const double period_s = secondsBetween(before->stamp, online.head.stamp);
  if (far_apart_.observe(period_s > kMostPeriod_s))
    return fmt::format("pairs are {:.4g} s apart: nothing that moves can be followed; times must be in seconds",
                       period_s);
  if (close_together_.observe(period_s < kLeastPeriod_s))
    return fmt::format("pairs are {:.4g} s apart: speeds cannot be right; times must be in seconds", period_s);
  const double speed_mps =
      (before->T_world_cam.inverse() * online.T_world_cam).translation().norm() / std::max(period_s, 1e-9);
  const bool measured = before->status == FrameStatus::kGood && online.head.status == FrameStatus::kGood;
  if (too_fast_.observe(measured && speed_mps > kMostSpeed_mps))
    return fmt::format(
        "the camera would move at {:.4g} m/s: are the times (or --fps) in seconds and the calibration in meters?",
        speed_mps);
  return std::nullopt;
}

}  // namespace motorcade
