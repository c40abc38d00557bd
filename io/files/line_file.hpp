#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/output_file.hpp"

namespace motorcade {

/// A text file that grows by whole lines per write, so that a program that is killed leaves whole lines behind.
/// Every failure is an OutputError naming the file.
class LineFile {
 public:
  /// Makes the file anew (`createOutput`).
  explicit LineFile(const std::filesystem::path& file) : file_(file) {}

  /// Writes the line and its end.
  void writeLine(std::string_view line);
  /// Writes lines and their ends, all in one go.
  void writeLines(const std::vector<std::string>& lines);
  /// Reports errors that the system held back until now. The destructor closes without reporting.
  void close() { file_.close(); }

 private:
  OutputFile file_;
  std::string buffer_;
};

/// Renames a file, replacing one that has the new name. Throws OutputError.
void replace(const std::filesystem::path& from, const std::filesystem::path& to);

/// Suffix of a file's name while `writeAtOnce` writes it.
inline constexpr const char* kUnfinishedSuffix = ".part";

/// Writes a whole file under another name and renames it: readers see all of it or nothing. Ends a text's last line.
void writeAtOnce(const std::filesystem::path& file, std::string_view text);
void writeBytesAtOnce(const std::filesystem::path& file, std::string_view bytes);

}  // namespace motorcade
