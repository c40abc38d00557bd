#include "apps/run/followed_frames.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace motorcade {
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

}  // namespace motorcade
