#include "apps/console/own_program.hpp"

#include "io/files/errors.hpp"

namespace motorcade {

std::filesystem::path ownProgram() {
  std::error_code error;
  auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) throw UsageError("this program's file cannot be found: mount /proc");
  return program;
}

}  // namespace motorcade
