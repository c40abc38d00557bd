#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace motorcade {

/// A text file that grows by one whole line per write, so that a program that is killed leaves whole lines behind.
/// Every failure is an OutputError naming the file.
class LineFile {
 public:
  /// Creates the file or empties it.
  explicit LineFile(const std::filesystem::path& file);
  ~LineFile();
  LineFile(LineFile&& other) noexcept;
  LineFile& operator=(LineFile&&) = delete;

  /// Writes the line and its end.
  void writeLine(std::string_view line);
  /// Reports errors that the system held back until now. The destructor closes without reporting.
  void close();

 private:
  std::filesystem::path file_;
  std::string buffer_;
  int descriptor_ = -1;
};

/// Writes a whole file under another name and renames it: readers see all of it or nothing.
void writeAtOnce(const std::filesystem::path& file, std::string_view content);

}  // namespace motorcade
