#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <span>
#include <string>
#include <string_view>

#include <sys/mman.h>
#include <unistd.h>

#include "io/files/errors.hpp"

/// Parts that the fuzz targets share: an input as a file in memory, and the check of what every refusal of one says.
namespace motorcade::fuzz {

/// A regular file that no folder holds; it has a path all the same.
class MemoryFile {
 public:
  MemoryFile() : number_(::memfd_create("input", MFD_CLOEXEC)), path_("/proc/self/fd/" + std::to_string(number_)) {}
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(number_); }

  /// The path of the file, which holds these bytes now.
  const std::filesystem::path& holding(std::string_view bytes) {
    if (::ftruncate(number_, 0) != 0 || ::pwrite(number_, bytes.data(), bytes.size(), 0) != std::ssize(bytes))
      std::abort();
    return path_;
  }

 private:
  int number_;
  std::filesystem::path path_;
};

inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A finding that no sanitizer sees.
inline void require(bool holds, std::string_view what) {
  if (holds) return;
  std::cerr << what << '\n';
  std::abort();
}

/// Requires that the message names the file first, then the line, unless the fault is that something is not in the file
/// at all. It must be text, whatever bytes the file has: one line, and the program's own commands, each on a line of
/// its own.
inline void requireClear(std::string_view message, std::string_view file, std::span<const std::string_view> no_line) {
  constexpr std::size_t kLongest = 600;
  const std::string said(message);
  require(message.starts_with(file), "the message names no file: " + said);
  const std::string_view rest = message.substr(file.size());
  bool clear = rest.starts_with(", line ") && rest.find_first_not_of("0123456789", 7) == rest.find(": ", 7);
  for (const std::string_view fault : no_line) clear = clear || rest.find(fault) != std::string_view::npos;
  require(clear, "the message names no line: " + said);
  require(message.size() < kLongest, "the message is long: " + said);
  for (std::size_t i = 0; i < message.size(); ++i) {
    const bool command = message[i] == '\n' && message.substr(i + 1).starts_with("  ");
    require(command || (message[i] >= ' ' && message[i] <= '~'), "the message is no text: " + said);
  }
}

/// Reads; a clear error of the user is an answer. Anything else that is thrown ends the program.
inline void readOrRefuse(std::string_view file, std::span<const std::string_view> no_line,
                         const std::function<void()>& read) {
  try {
    read();
  } catch (const UserError& error) {
    requireClear(error.what(), file, no_line);
  }
}

}  // namespace motorcade::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
