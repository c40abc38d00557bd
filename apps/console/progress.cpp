#include "apps/console/progress.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "apps/console/log.hpp"

namespace motorcade {
namespace {

constexpr auto kBarPeriod = std::chrono::milliseconds(100);
constexpr auto kLinePeriod = std::chrono::seconds(3);

/// Columns of the terminal of standard error. It is asked each time, as the user may resize it.
std::size_t terminalColumns() {
  constexpr std::size_t kUsual = 80;  // of terminals that do not know
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsual;
}

}  // namespace

std::string progressLine(double share_done, const std::string& text, std::size_t columns) {
  constexpr std::size_t kLeastBar = 10, kMostBar = 40, kAround = 3;  // brackets and a blank
  if (text.size() + kLeastBar + kAround > columns) return text.substr(0, columns);
  const std::size_t bar = std::min(kMostBar, columns - text.size() - kAround);
  const auto filled = static_cast<std::size_t>(std::clamp(share_done, 0.0, 1.0) * static_cast<double>(bar));
  return fmt::format("[{:#<{}}{:.<{}}] {}", "", filled, "", bar - filled, text);
}

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
  if (!tellsProgress()) return;
  const auto now = Clock::now();
  if (now < next_ && !(terminal_ && done == count_)) return;
  next_ = now + (terminal_ ? Clock::duration(kBarPeriod) : Clock::duration(kLinePeriod));
  const double rate_hz = static_cast<double>(done) / std::chrono::duration<double>(now - start_).count();
  const auto text =
      fmt::format("{0} {1}{2}, {3:.1f} {0}s/s{4}{5}", item_, done, count_ > 0 ? fmt::format(" of {}", count_) : "",
                  rate_hz, more.empty() ? "" : ", ", more);
  if (!terminal_) {
    logInfo(text);
    return;
  }
  const std::size_t columns = terminalColumns() - 1;  // in the last one, the cursor may go on to the next line
  const std::string line = count_ > 0
                               ? progressLine(static_cast<double>(done) / static_cast<double>(count_), text, columns)
                               : text.substr(0, columns);
  std::fprintf(stderr, "\r%s\033[K", line.c_str());
  line_open_ = true;
}

}  // namespace motorcade
