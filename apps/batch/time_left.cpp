#include "apps/batch/time_left.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

namespace motorcade {

double weightOf(const Task& task) {
  constexpr double kOverhead = 10;  // starting, evaluating and renaming, in frames
  return kOverhead + static_cast<double>(task.frames);
}

double framesWritten(const std::filesystem::path& run) {
  std::ifstream file(run / "frames.csv", std::ios::binary);
  const auto lines = std::count(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>(), '\n');
  return std::max(0.0, static_cast<double>(lines - 1));
}

std::string TimeLeft::text(double done) const {
  if (done <= 0) return "time left not known yet";
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
  return durationText(elapsed_s * std::max(0.0, whole_ - done) / done) + " left";
}

std::string durationText(double seconds) {
  constexpr double kMinute_s = 60, kHour_s = 3600;
  const auto whole = [](double value) { return static_cast<long>(std::floor(value)); };
  if (seconds < kMinute_s) return fmt::format("{} s", std::lround(seconds));
  if (seconds < kHour_s) return fmt::format("{} min", std::lround(seconds / kMinute_s));
  return fmt::format("{} h {} min", whole(seconds / kHour_s), whole(std::fmod(seconds, kHour_s) / kMinute_s));
}

}  // namespace motorcade
