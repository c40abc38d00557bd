#include "apps/console/progress.hpp"

#include <cstdio>
#include <utility>

#include <spdlog/spdlog.h>
#include <unistd.h>

namespace motorcade {
namespace {

constexpr std::size_t kBarWidth = 40;
constexpr auto kBarPeriod = std::chrono::milliseconds(100);
constexpr auto kLinePeriod = std::chrono::seconds(3);

}  // namespace

Progress::Progress(std::string item, std::size_t count)
    : item_(std::move(item)),
      count_(count),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_(terminal_ ? start_ : start_ + kLinePeriod) {}

Progress::~Progress() {
  if (line_open_) std::fputc('\n', stderr);
}

void Progress::show(std::size_t done, const std::string& more) {
  const auto now = Clock::now();
  if (now < next_ && !(terminal_ && done == count_)) return;
  next_ = now + (terminal_ ? Clock::duration(kBarPeriod) : Clock::duration(kLinePeriod));
  const double rate_hz = static_cast<double>(done) / std::chrono::duration<double>(now - start_).count();
  const auto text =
      fmt::format("{0} {1} of {2}, {3:.1f} {0}s/s{4}{5}", item_, done, count_, rate_hz, more.empty() ? "" : ", ", more);
  if (!terminal_) {
    spdlog::info(text);
    return;
  }
  const std::size_t filled = count_ > 0 ? kBarWidth * done / count_ : kBarWidth;
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r[%s] %s\033[K", bar.c_str(), text.c_str());
  line_open_ = true;
}

}  // namespace motorcade
