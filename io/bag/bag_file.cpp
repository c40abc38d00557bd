#include "io/bag/bag_file.hpp"

#include <cassert>
#include <cerrno>
#include <cstring>

#include <unistd.h>

#include "io/files/errors.hpp"

namespace motorcade {

BagFile::BagFile(const std::filesystem::path& file)
    : name_(file.string()), file_(openInput(file)), size_(file_.bytes) {}

void BagFile::moveTo(std::uint64_t position) {
  assert(position <= size_);
  position_ = position;
}

void BagFile::read(std::span<std::uint8_t> bytes) {
  assert(bytes.size() <= left());
  while (!bytes.empty()) {
    const ssize_t got = ::pread(file_.descriptor.number(), bytes.data(), bytes.size(), static_cast<off_t>(position_));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(placeOf(position_) + ": cannot be read: " + std::strerror(errno));
    if (got == 0) throw InputError(placeOf(position_) + ": the file has become shorter while it is read");
    position_ += static_cast<std::uint64_t>(got);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
}

}  // namespace motorcade
