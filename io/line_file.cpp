#include "io/line_file.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "io/errors.hpp"

namespace motorcade {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const char* what) {
  throw OutputError(file.string() + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

LineFile::LineFile(const std::filesystem::path& file) : file_(file) {
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(file_, "cannot be created");
}

LineFile::~LineFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

LineFile::LineFile(LineFile&& other) noexcept
    : file_(std::move(other.file_)),
      buffer_(std::move(other.buffer_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

void LineFile::writeLine(std::string_view line) {
  buffer_.assign(line);
  buffer_ += '\n';
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(file_, "cannot be written");
    rest.remove_prefix(written);  // a disk that is almost full takes a part, and refuses the next
  }
}

void LineFile::close() {
  if (descriptor_ >= 0 && ::close(std::exchange(descriptor_, -1)) != 0) fail(file_, "cannot be closed");
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
  std::error_code error;
  std::filesystem::rename(unfinished, file, error);
  if (error) throw OutputError(file.string() + ": cannot be written: " + error.message());
}

}  // namespace motorcade
