#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace motorcade {

/// A progress bar, as far as there is room for it, and the text, of at most `columns` columns.
std::string progressLine(double share_done, const std::string& text, std::size_t columns);

/// Shows the progress of the work: a bar in one line of a terminal, or a plain line every few seconds. Writes to
/// standard error, and nothing if the user wants warnings and errors only.
class Progress {
 public:
  /// `item` is the singular of the counted things; `count` is 0 if it is not known.
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
