#include "apps/run/progress.hpp"

#include <cstdio>
#include <string>

#include <spdlog/spdlog.h>
#include <unistd.h>

namespace motorcade {
namespace {

constexpr std::size_t kBarWidth = 40;
constexpr auto kBarPeriod = std::chrono::milliseconds(100);
constexpr auto kLinePeriod = std::chrono::seconds(3);

}  // namespace

Progress::Progress(std::size_t frames)
    : frames_(frames),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_(terminal_ ? start_ : start_ + kLinePeriod) {}

Progress::~Progress() {
  if (line_open_) std::fputc('\n', stderr);
}

void Progress::show(std::size_t done, double latency_ms) {
  const auto now = Clock::now();
  if (now < next_ && !(terminal_ && done == frames_)) return;
  next_ = now + (terminal_ ? Clock::duration(kBarPeriod) : Clock::duration(kLinePeriod));
  const double rate_hz = static_cast<double>(done) / std::chrono::duration<double>(now - start_).count();
  const auto text =
      fmt::format("frame {} of {}, {:.1f} frames/s, latency {:.1f} ms", done, frames_, rate_hz, latency_ms);
  if (!terminal_) {
    spdlog::info(text);
    return;
  }
  const std::size_t filled = frames_ > 0 ? kBarWidth * done / frames_ : kBarWidth;
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r[%s] %s\033[K", bar.c_str(), text.c_str());
  line_open_ = true;
}

}  // namespace motorcade
