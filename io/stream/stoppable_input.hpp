#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/files/file_descriptor.hpp"

namespace motorcade {

/// Reads a descriptor that may stay silent, as a pipe does. One thread reads; `stop`, from any thread, ends its wait.
class StoppableInput {
 public:
  /// The descriptor stays the caller's. Throws InputError where it is none that can be read. `name` is for messages.
  StoppableInput(int descriptor, std::string name);

  /// Fills `bytes`, and gives how many came: fewer at the end and after `stop`. Throws InputError.
  std::size_t read(std::span<std::uint8_t> bytes);
  /// Reads up to the next end of a line, and with it; without one at the end, after `stop`, and where `most` bytes have
  /// none. Throws InputError.
  std::string readLine(std::size_t most);

  void stop();
  bool stopped() const { return stopped_.load(); }
  const std::string& name() const { return name_; }

 private:
  std::size_t readSome(std::span<std::uint8_t> bytes);
  bool waitForBytes();

  int descriptor_;
  std::string name_;
  FileDescriptor wake_;
  std::atomic<bool> stopped_{false};
  std::vector<std::uint8_t> ahead_;  // read for a line, and beyond it
  std::size_t ahead_begin_ = 0;
};

}  // namespace motorcade
