#pragma once

#include <filesystem>

#include "io/files/file_descriptor.hpp"

namespace motorcade {

/// Keeps a folder for one writer. A second lock, of this process or another, fails while the first one lives. The lock
/// ends with its process, however that ends. Throws OutputError.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  /// Fails when the folder was removed or renamed, or another one has its name.
  void check() const;

 private:
  std::filesystem::path folder_;
  FileDescriptor descriptor_;
};

}  // namespace motorcade
