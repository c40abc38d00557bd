#include "io/stream/stoppable_input.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

[[noreturn]] void failToRead(const std::string& name) {
  throw InputError(name + ": cannot be read: " + std::strerror(errno));
}

/// Checked before any other descriptor is opened, which would get the number of a closed one.
int readable(int descriptor, const std::string& name) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags < 0 || (flags & O_ACCMODE) == O_WRONLY) throw InputError(name + ": is closed; pipe a stream into it");
  return descriptor;
}

}  // namespace

StoppableInput::StoppableInput(int descriptor, std::string name)
    : descriptor_(readable(descriptor, name)), name_(std::move(name)), wake_(::eventfd(0, EFD_CLOEXEC)) {
  constexpr int kRoom = 1 << 20;  // the most that a user may ask for; without it all works as well
  if (wake_.number() < 0) failToRead(name_);
  ::fcntl(descriptor_, F_SETPIPE_SZ, kRoom);
}

void StoppableInput::stop() {
  stopped_.store(true);
  ::eventfd_write(wake_.number(), 1);
}

/// False after `stop`.
bool StoppableInput::waitForBytes() {
  constexpr int kForever = -1;
  std::array<pollfd, 2> waited{pollfd{descriptor_, POLLIN, 0}, pollfd{wake_.number(), POLLIN, 0}};
  while (::poll(waited.data(), waited.size(), kForever) < 0)
    if (errno != EINTR) failToRead(name_);
  return !stopped();
}

/// None at the end and after `stop`.
std::size_t StoppableInput::readSome(std::span<std::uint8_t> bytes) {
  while (waitForBytes()) {
    const ssize_t got = ::read(descriptor_, bytes.data(), bytes.size());
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR && errno != EAGAIN) failToRead(name_);
  }
  return 0;
}

std::size_t StoppableInput::read(std::span<std::uint8_t> bytes) {
  std::size_t filled = std::min(bytes.size(), ahead_.size() - ahead_begin_);
  std::copy_n(ahead_.begin() + static_cast<std::ptrdiff_t>(ahead_begin_), filled, bytes.begin());
  ahead_begin_ += filled;
  while (filled < bytes.size()) {
    const std::size_t got = readSome(bytes.subspan(filled));
    if (got == 0) break;
    filled += got;
  }
  return filled;
}

std::string StoppableInput::readLine(std::size_t most) {
  constexpr std::size_t kChunk = 256;
  std::string line;
  while (line.size() < most) {
    if (ahead_begin_ == ahead_.size()) {
      ahead_.resize(kChunk);
      ahead_begin_ = 0;
      ahead_.resize(readSome(ahead_));
      if (ahead_.empty()) break;
    }
    line.push_back(static_cast<char>(ahead_[ahead_begin_++]));
    if (line.back() == '\n') break;
  }
  return line;
}

}  // namespace motorcade
