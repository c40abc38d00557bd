#include "io/line_file.hpp"

#include <cerrno>
#include <cstring>

#include <unistd.h>

#include "io/errors.hpp"

namespace motorcade {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const char* what) {
  throw OutputError(file.string() + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

LineFile::LineFile(const std::filesystem::path& file) : file_(file), descriptor_(createOutput(file)) {}

void LineFile::writeLine(std::string_view line) {
  buffer_.assign(line);
  buffer_ += '\n';
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_.number(), rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(file_, "cannot be written");
    rest.remove_prefix(written);  // a disk that is almost full takes a part, and refuses the next
  }
}

void LineFile::close() {
  if (descriptor_.number() >= 0 && ::close(descriptor_.release()) != 0) fail(file_, "cannot be closed");
}

void replace(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  if (error) throw OutputError(to.string() + ": cannot be written: " + error.message());
}

void writeAtOnce(const std::filesystem::path& file, std::string_view content) {
  std::filesystem::path unfinished = file;
  unfinished += ".part";
  try {
    LineFile out(unfinished);
    if (content.ends_with('\n')) content.remove_suffix(1);
    out.writeLine(content);
    out.close();
  } catch (const OutputError&) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw;
  }
  replace(unfinished, file);
}

}  // namespace motorcade
