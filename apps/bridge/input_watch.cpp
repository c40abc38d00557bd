#include "apps/bridge/input_watch.hpp"

#include <utility>

#include <fmt/format.h>

namespace motorcade {
InputWatch::InputWatch(Params params, Clock::time_point start)
    : params_(std::move(params)), images_{Stream{.last = start}, Stream{.last = start}}, pairs_{.last = start} {}

bool InputWatch::changed(Stream& stream, Clock::time_point now) const {
  const bool silent = now - stream.last >= params_.patience;
  return std::exchange(stream.silent, silent) != silent;
}

std::string InputWatch::silenceOf(StereoSide side) const {
  return fmt::format("no images on {} for {:.1f} s", params_.topics[indexOf(side)],
                     std::chrono::duration<double>(params_.patience).count());
}

std::string InputWatch::problemNow() const {
  std::string problem;
  for (const StereoSide side : kStereoSides)
    if (images_[indexOf(side)].silent) problem += (problem.empty() ? "" : "; ") + silenceOf(side);
  if (!problem.empty() || !pairs_.silent) return problem;
  return fmt::format("no pairs: no stamps on {} and {} are within {} ms of each other", params_.topics[0],
                     params_.topics[1], static_cast<double>(params_.tolerance_ns) * 1e-6);
}

std::vector<InputWatch::News> InputWatch::look(Clock::time_point now) {
  std::vector<News> news;
  for (const StereoSide side : kStereoSides) {
    Stream& images = images_[indexOf(side)];
    if (!changed(images, now)) continue;
    if (images.silent) {
      news.push_back({.bad = true, .text = silenceOf(side), .side = side});
    } else {
      news.push_back({.text = "images come again on " + params_.topics[indexOf(side)], .side = side});
      pairs_.last = now;  // there could be none
    }
  }
  const bool complete = !images_[0].silent && !images_[1].silent;
  const bool pairs_changed = complete && changed(pairs_, now);
  problem_ = problemNow();
  if (pairs_changed && pairs_.silent) news.push_back({.bad = true, .text = problem_});
  if (pairs_changed && !pairs_.silent) news.push_back({.text = "stamps agree again"});
  return news;
}

ros::DiagnosticStatus inputStatusOf(const InputCounts& counts, const std::string& problem,
                                    const std::string& hardware_id) {
  using Level = ros::DiagnosticStatus::Level;
  return {.level = problem.empty() ? Level::kOk : Level::kError,
          .name = "motorcade: images",
          .message = problem.empty() ? "images come on both topics" : problem,
          .hardware_id = hardware_id,
          .values = {{"pairs", std::to_string(counts.pairs)},
                     {"unpaired_left", std::to_string(counts.unpaired[0])},
                     {"unpaired_right", std::to_string(counts.unpaired[1])},
                     {"unreadable", std::to_string(counts.unreadable)},
                     {"rejected", std::to_string(counts.rejected)},
                     {"overtaken", std::to_string(counts.overtaken)}}};
}

}  // namespace motorcade
