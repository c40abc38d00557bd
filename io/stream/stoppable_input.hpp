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
  /// The caller keeps the descriptor. Throws InputError if it cannot be read. `name` is for messages.
  StoppableInput(int descriptor, std::string name);

  /// Fills `bytes` and returns their number, which is smaller at the end and after `stop`. Throws InputError.
  std::size_t read(std::span<std::uint8_t> bytes);
  /// Reads a line with its end. The end is missing at the end of the input, after `stop`, and where the first `most`
  /// bytes have none. Throws InputError.
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
