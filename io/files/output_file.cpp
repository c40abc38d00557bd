#include "io/files/output_file.hpp"

#include <cerrno>
#include <cstring>

#include <unistd.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const char* what) {
  throw OutputError(file.string() + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& file) : file_(file), descriptor_(createOutput(file)) {}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_.number(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(file_, "cannot be written");
    bytes.remove_prefix(written);  // a disk that is almost full takes a part, and refuses the next
  }
}

void OutputFile::close() {
  if (descriptor_.number() >= 0 && ::close(descriptor_.release()) != 0) fail(file_, "cannot be closed");
}

}  // namespace motorcade
