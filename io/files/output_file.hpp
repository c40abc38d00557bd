#pragma once

#include <filesystem>
#include <string_view>

#include "io/files/file_descriptor.hpp"

namespace motorcade {

/// An unbuffered file: each write reaches the system at once, so that nothing is lost when the program is killed. Every
/// failure is an OutputError naming the file.
class OutputFile {
 public:
  /// Makes the file anew (`createOutput`).
  explicit OutputFile(const std::filesystem::path& file);

  void write(std::string_view bytes);
  /// Reports errors that the system held back until now. The destructor closes without reporting.
  void close();

 private:
  std::filesystem::path file_;
  FileDescriptor descriptor_;
};

}  // namespace motorcade
