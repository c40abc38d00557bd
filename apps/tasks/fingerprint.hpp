#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Tells whether all inputs of a result are still the same. The same values in the same order give the same text. It
/// does not withstand a deliberate search for a collision.
class Fingerprint {
 public:
  Fingerprint();
  ~Fingerprint();
  Fingerprint(const Fingerprint&) = delete;
  Fingerprint& operator=(const Fingerprint&) = delete;

  /// Adds a text. Two texts in a row differ from their concatenation.
  void add(std::string_view text);
  void add(double number);
  /// Adds a file's name, size and time of change, or that it is missing.
  void addFile(const std::filesystem::path& file);
  /// 32 hexadecimal digits.
  std::string text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Stamp of a file's name, size and time of change.
std::string fileStamp(const std::filesystem::path& file);

/// Fingerprint of the bytes of a program and its modules. Throws UsageError where it cannot be read.
std::string programFingerprint(const std::filesystem::path& program);

/// Fingerprint of a recorded drive: its images and files of truth by name, size and time of change, its cameras by
/// their numbers.
std::string sequenceFingerprint(const Sequence& sequence);

}  // namespace motorcade
