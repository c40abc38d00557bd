#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "io/files/file_descriptor.hpp"

namespace motorcade {

/// A file that is read piece by piece, with the size that it had when it was opened. Throws InputError.
class BagFile {
 public:
  explicit BagFile(const std::filesystem::path& file);

  std::uint64_t position() const { return position_; }
  std::uint64_t size() const { return size_; }
  std::uint64_t left() const { return size_ - position_; }
  /// Moves to a position within the file.
  void moveTo(std::uint64_t position);
  /// Fills `bytes`, which must not be larger than `left()`.
  void read(std::span<std::uint8_t> bytes);

  const std::string& name() const { return name_; }
  /// FILE: byte POSITION, for messages.
  std::string placeOf(std::uint64_t position) const { return name_ + ": byte " + std::to_string(position); }

 private:
  std::string name_;
  InputFile file_;
  std::uint64_t size_, position_ = 0;
};

}  // namespace motorcade
