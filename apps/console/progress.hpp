#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace motorcade {

/// A bar of what is done, as far as there is room for it, and the text: at most so many columns.
std::string progressLine(double share_done, const std::string& text, std::size_t columns);

/// Shows how far the work is: a bar on a terminal, in one line of it, a plain line every few seconds otherwise. Writes
/// to the standard error output, and nothing where the user wants to read warnings and errors only.
class Progress {
 public:
  /// `item` is the singular of what is counted; `count` is 0 where nobody knows how many there are.
  Progress(std::string item, std::size_t count);
  /// Ends the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows how many items are done, and a further text.
  void show(std::size_t done, const std::string& more = "");

 private:
  using Clock = std::chrono::steady_clock;
  std::string item_;
  std::size_t count_;
  bool terminal_;
  Clock::time_point start_, next_;
  bool line_open_ = false;
};

}  // namespace motorcade
