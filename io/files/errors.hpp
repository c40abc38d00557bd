#pragma once

#include <stdexcept>
#include <string>

namespace motorcade {

/// An error that a user can fix. The message names the file, the line or key, and how to fix it; `main` turns it into
/// the exit code.
class UserError : public std::runtime_error {
 public:
  UserError(const std::string& message, int exit_code) : std::runtime_error(message), exit_code_(exit_code) {}
  int exitCode() const { return exit_code_; }

 private:
  int exit_code_;
};

/// A wrong command line or configuration.
struct UsageError : UserError {
  explicit UsageError(const std::string& message) : UserError(message, 2) {}
};

/// An input or a calibration that cannot be used.
struct InputError : UserError {
  explicit InputError(const std::string& message) : UserError(message, 3) {}
};

/// An output that could not be written.
struct OutputError : UserError {
  explicit OutputError(const std::string& message) : UserError(message, 4) {}
};

}  // namespace motorcade
