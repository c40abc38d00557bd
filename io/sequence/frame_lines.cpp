#include "io/sequence/frame_lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <utility>

#include "io/files/errors.hpp"
#include "io/sequence/pairing.hpp"
#include "io/sequence/pose_interpolation.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

bool hasLeft(const FramePaths& frame) { return !frame.left_missing; }
bool hasRight(const FramePaths& frame) { return !frame.right_missing; }
bool hasAny(const FramePaths& frame) { return hasLeft(frame) || hasRight(frame); }
bool isPair(const FramePaths& frame) { return frame.isPair(); }

/// A line for each frame that has these images.
FramesOfLines lineForEach(const Sequence& sequence, bool (*has)(const FramePaths&)) {
  FramesOfLines frames;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i)
    if (has(sequence.frames[i])) frames.push_back(static_cast<std::int64_t>(i));
  return frames;
}

/// A line for each number from the first one, or from 0, also where it has no frame.
FramesOfLines lineForEachNumber(const Sequence& sequence, std::size_t lines, std::int64_t first, std::int64_t step) {
  FramesOfLines frames(lines, -1);
  for (std::size_t i = 0; i < sequence.frames.size(); ++i)
    frames.at(static_cast<std::size_t>(first + step * placeOf(sequence, i))) = static_cast<std::int64_t>(i);
  return frames;
}

std::string formatted(const char* format, double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

/// Describes the numbers of lines that a file may have, for messages.
std::string neededLines(const Sequence& sequence) {
  const std::size_t numbers = static_cast<std::size_t>(placeOf(sequence, sequence.frames.size() - 1)) + 1;
  const auto counted = [&](bool (*has)(const FramePaths&)) {
    return std::to_string(std::ranges::count_if(sequence.frames, has));
  };
  return "one for each number (" + std::to_string(numbers) + "), for each left image (" + counted(hasLeft) +
         ") or for each pair (" + counted(isPair) + ")";
}

/// The lines that have a frame, and the median time from one place to the next.
struct TimedLines {
  std::vector<std::size_t> lines;
  double period_ns = 0;
};

TimedLines timedLines(const Sequence& sequence, const FramesOfLines& frames, const std::vector<Timestamp>& times) {
  TimedLines timed;
  for (std::size_t line = 0; line < frames.size(); ++line)
    if (frames[line] >= 0) timed.lines.push_back(line);
  std::vector<double> periods_ns;
  for (std::size_t i = 1; i < timed.lines.size(); ++i) {
    const std::size_t from = timed.lines[i - 1], to = timed.lines[i];
    periods_ns.push_back(static_cast<double>(times[to].ns - times[from].ns) /
                         static_cast<double>(placeOf(sequence, frames[to]) - placeOf(sequence, frames[from])));
  }
  if (periods_ns.empty()) return timed;
  const auto middle = periods_ns.begin() + std::ssize(periods_ns) / 2;
  std::ranges::nth_element(periods_ns, middle);
  timed.period_ns = *middle;
  return timed;
}

/// Checks that enough time passes where frames have no line of their own.
bool agree(const Sequence& sequence, const FramesOfLines& frames, const std::vector<Timestamp>& times) {
  constexpr double kLeast = 0.6;  // of the usual time from place to place
  const TimedLines timed = timedLines(sequence, frames, times);
  for (std::size_t i = 1; i < timed.lines.size(); ++i) {
    const std::size_t from = timed.lines[i - 1], to = timed.lines[i];
    const auto places = static_cast<double>(placeOf(sequence, frames[to]) - placeOf(sequence, frames[from]));
    if (places > 1 && static_cast<double>(times[to].ns - times[from].ns) < kLeast * places * timed.period_ns)
      return false;
  }
  return true;
}

std::optional<FramesOfLines> agreeingWay(const Sequence& sequence, const std::vector<Timestamp>& times) {
  for (const FramesOfLines& way : waysToRead(sequence, times.size()))
    if (agree(sequence, way, times)) return way;
  return std::nullopt;
}

/// Interpolates stamps between lines, and extrapolates them at the median rate before the first and after the last.
void interpolateStamps(Sequence& sequence, const FramesOfLines& frames, const std::vector<Timestamp>& times) {
  const TimedLines timed = timedLines(sequence, frames, times);
  sequence.stamps.assign(sequence.frames.size(), {});
  const auto placeOfLine = [&](std::size_t line) { return placeOf(sequence, frames[line]); };
  auto after = timed.lines.begin();  // the first line of this frame or a later one
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const std::int64_t place = placeOf(sequence, i);
    while (after != timed.lines.end() && placeOfLine(*after) < place) ++after;
    if (after != timed.lines.end() && placeOfLine(*after) == place) {
      sequence.stamps[i] = times[*after];
      continue;
    }
    const std::size_t near = after == timed.lines.begin() ? *after : *std::prev(after);
    double period_ns = timed.period_ns;
    if (after != timed.lines.begin() && after != timed.lines.end())
      period_ns = static_cast<double>(times[*after].ns - times[near].ns) /
                  static_cast<double>(placeOfLine(*after) - placeOfLine(near));
    sequence.stamps[i] = {times[near].ns + std::llround(static_cast<double>(place - placeOfLine(near)) * period_ns)};
  }
}

}  // namespace

std::int64_t placeOf(const Sequence& sequence, std::size_t frame) {
  const auto& places = sequence.numbering.places;
  return places.empty() ? static_cast<std::int64_t>(frame) : places[frame];
}

bool isComplete(const Sequence& sequence) {
  return sequence.numbering.places.empty() && std::ranges::all_of(sequence.frames, isPair);
}

std::vector<FramesOfLines> waysToRead(const Sequence& sequence, std::size_t lines) {
  std::vector<FramesOfLines> ways;
  const auto add = [&](FramesOfLines way) {
    if (way.size() == lines && std::ranges::find(ways, way) == ways.end()) ways.push_back(std::move(way));
  };
  if (sequence.frames.empty()) return ways;
  const auto count = static_cast<std::int64_t>(lines);
  const auto [first, step, places] = sequence.numbering;
  const std::int64_t last_place = placeOf(sequence, sequence.frames.size() - 1), last = first + step * last_place;
  if (count == last_place + 1) add(lineForEachNumber(sequence, lines, 0, 1));
  add(lineForEach(sequence, [](const FramePaths&) { return true; }));
  add(lineForEach(sequence, hasAny));
  add(lineForEach(sequence, hasLeft));
  add(lineForEach(sequence, hasRight));
  add(lineForEach(sequence, isPair));
  if (first >= 0 && count > last && count <= last + step) add(lineForEachNumber(sequence, lines, first, step));
  return ways;
}

bool linesBelongToNumbers(const Sequence& sequence, std::size_t lines) {
  if (sequence.frames.empty() || lines == sequence.frames.size()) return false;
  return !isComplete(sequence) || !waysToRead(sequence, lines).empty();
}

FramesOfLines framesOfLines(const Sequence& sequence, std::size_t lines, const fs::path& file,
                            const std::string& what) {
  const auto ways = waysToRead(sequence, lines);
  if (!ways.empty()) return ways.front();
  throw InputError(file.string() + ": has " + std::to_string(lines) + " " + what +
                   ", but images are missing or numbered with gaps; " + neededLines(sequence) + " is needed");
}

void setStampsOfLines(Sequence& sequence, const std::vector<Timestamp>& times, const fs::path& file) {
  auto way = agreeingWay(sequence, times);
  if (!way && !waysToRead(sequence, times.size()).empty() && !isComplete(sequence)) {
    Sequence closed = sequence;
    closeNumbers(closed);
    way = agreeingWay(closed, times);
    if (way) sequence = std::move(closed);
  }
  if (way) return interpolateStamps(sequence, *way, times);
  if (isComplete(sequence))
    throw InputError(file.string() + ": has " + std::to_string(times.size()) + " times for " +
                     std::to_string(sequence.frames.size()) + " images; one line per image is needed");
  const bool counted = !waysToRead(sequence, times.size()).empty();
  throw InputError(file.string() + ": has " + std::to_string(times.size()) + " times, " +
                   (counted ? "which pass over no image that is missing" : "but images are missing") + "; " +
                   neededLines(sequence) + " is needed, or no times.txt and the rate by --fps");
}

std::vector<SE3> posesOfFrames(const Sequence& sequence, const std::vector<SE3>& poses, const fs::path& file) {
  const FramesOfLines frames = framesOfLines(sequence, poses.size(), file, "poses");
  std::vector<SE3> known;
  std::vector<Timestamp> places;  // as times, between which poses are interpolated
  for (std::size_t line = 0; line < frames.size(); ++line) {
    if (frames[line] < 0) continue;
    known.push_back(poses[line]);
    places.push_back({placeOf(sequence, frames[line])});
  }
  std::vector<SE3> result;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const Timestamp place{placeOf(sequence, i)};
    const auto at = std::ranges::lower_bound(places, place);
    const bool exact = at != places.end() && *at == place;
    result.push_back(exact || places.size() < 2 ? known[std::min<std::size_t>(at - places.begin(), known.size() - 1)]
                                                : poseAt(place, known, places));
  }
  return result;
}

void tellPeriod(Sequence& sequence) {
  constexpr double kMost_s = 2, kLeast_s = 5e-4;
  constexpr double kFarTooLong_s = 10;  // nothing can be followed over as long
  if (sequence.stamps.size() < 2) return;
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < sequence.stamps.size(); ++i)
    periods_s.push_back(secondsBetween(sequence.stamps[i - 1], sequence.stamps[i]));
  const auto middle = periods_s.begin() + std::ssize(periods_s) / 2;
  std::ranges::nth_element(periods_s, middle);
  const double period_s = *middle;
  if (period_s >= kLeast_s && period_s <= kMost_s) return;
  const std::string mend =
      sequence.stamps_measured ? "look at the times, which must be in seconds" : "give the rate of the camera, --fps";
  sequence.notes.push_back({"times",
                            "pairs are " + formatted("%.4g", period_s) + " s apart, " +
                                (period_s > kMost_s ? "too far to follow anything" : "so that no speed can be right") +
                                "; " + mend,
                            period_s > kFarTooLong_s || period_s < kLeast_s});
}

}  // namespace motorcade
