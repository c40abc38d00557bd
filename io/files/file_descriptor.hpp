#pragma once

#include <cstddef>
#include <filesystem>
#include <utility>

namespace motorcade {

/// Owns an open file.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  ~FileDescriptor();
  FileDescriptor(FileDescriptor&& other) noexcept : number_(other.release()) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;

  int number() const { return number_; }
  /// Whoever takes it closes it.
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

/// An input, with the size that it has when it is opened.
struct InputFile {
  FileDescriptor descriptor;
  std::size_t bytes;
};
/// Opens a regular file, or a link to one. A folder, a FIFO, a socket or a device is refused without waiting. Throws
/// InputError.
InputFile openInput(const std::filesystem::path& file);

/// Creates a file anew beside an existing one and takes its name. A link is replaced and not followed; a reader of the
/// previous file goes on reading that. Anything but a regular file or a link is refused. Throws OutputError.
FileDescriptor createOutput(const std::filesystem::path& file);

/// Makes a folder, with those above it, unless it is there. Throws OutputError.
void makeFolder(const std::filesystem::path& folder);

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
