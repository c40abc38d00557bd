#include "apps/console/progress.hpp"

#include <array>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "apps/console/log.hpp"

namespace motorcade {
namespace {

using testing::HasSubstr;

const std::string kText = "frame 30 of 60, 31.2 frames/s, latency 27.3 ms";

TEST(ProgressLine, TakesNoMoreThanTheColumnsThereAre) {
  EXPECT_EQ(progressLine(0.5, kText, 200), "[" + std::string(20, '#') + std::string(20, '.') + "] " + kText);
  for (std::size_t columns = 0; columns < 120; ++columns) EXPECT_LE(progressLine(0.5, kText, columns).size(), columns);
  EXPECT_EQ(progressLine(1, kText, 79).size(), 79U);
  EXPECT_EQ(progressLine(0.5, kText, 50), kText) << "no room for a bar";
  EXPECT_EQ(progressLine(0.5, kText, 8), "frame 30");
}

TEST(ProgressLine, HasNoBarThatIsMoreThanFull) {
  EXPECT_EQ(progressLine(1.5, "", 43), "[" + std::string(40, '#') + "] ");
}

/// Takes the standard error output for a terminal of so many columns.
class Terminal {
 public:
  explicit Terminal(unsigned short columns)
      : master_(::posix_openpt(O_RDWR | O_NOCTTY)), before_(::dup(STDERR_FILENO)) {
    if (::grantpt(master_) != 0 || ::unlockpt(master_) != 0) return;
    const int terminal = ::open(::ptsname(master_), O_RDWR | O_NOCTTY);
    winsize size{};
    size.ws_col = columns;
    ready_ = terminal >= 0 && ::ioctl(terminal, TIOCSWINSZ, &size) == 0 && ::dup2(terminal, STDERR_FILENO) >= 0;
    ::close(terminal);
  }
  ~Terminal() {
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
    ::close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  bool ready() const { return ready_; }
  std::string shown() const {
    constexpr int kPatience_ms = 500;
    pollfd there{.fd = master_, .events = POLLIN, .revents = 0};
    if (::poll(&there, 1, kPatience_ms) != 1) return {};
    std::array<char, 4096> text{};
    const auto count = ::read(master_, text.data(), text.size());
    return {text.data(), static_cast<std::size_t>(count > 0 ? count : 0)};
  }

 private:
  int master_, before_;
  bool ready_ = false;
};

TEST(Progress, FitsIntoTheTerminal) {
  const Terminal terminal(60);
  if (!terminal.ready()) GTEST_SKIP() << "no terminal can be made here";
  Progress progress("frame", 60);
  progress.show(60, "latency 27.3 ms");
  const std::string shown = terminal.shown();
  const auto end = shown.find("\033[K");
  ASSERT_NE(end, std::string::npos) << shown;
  EXPECT_EQ(shown.front(), '\r');
  EXPECT_LT(end - 1, 60U) << shown;
  EXPECT_THAT(shown, HasSubstr("frame 60 of 60"));
}

TEST(Progress, IsQuietWhereOnlyWarningsAreAskedFor) {
  const Terminal terminal(60);
  if (!terminal.ready()) GTEST_SKIP() << "no terminal can be made here";
  setLogLevel("warning");
  Progress("frame", 60).show(60);
  setLogLevel("info");
  EXPECT_EQ(terminal.shown(), "");
}

}  // namespace
}  // namespace motorcade
