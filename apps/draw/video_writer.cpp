#include "apps/draw/video_writer.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds(120);  // with an ffmpeg that takes nothing, or does not end
constexpr auto kLastWords = std::chrono::seconds(5);   // from when it takes nothing more until it has said why
constexpr auto kStep = std::chrono::milliseconds(50);

bool isWebm(const fs::path& file) { return file.extension() == ".webm"; }

/// Arguments of ffmpeg. The pictures are padded to even sides, which these formats require.
std::vector<std::string> argumentsFor(const fs::path& partial, bool webm, const VideoWriter::Format& format) {
  const std::string rate = std::to_string(format.rate_hz);
  std::vector<std::string> arguments{"-hide_banner", "-loglevel", "error", "-nostdin", "-y"};
  const auto add = [&](std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  add({"-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", format.size.text(), "-framerate", rate});
  add({"-i", "pipe:0", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"});
  if (webm)
    add({"-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-cpu-used", "4", "-row-mt", "1", "-f", "webm"});
  else
    add({"-c:v", "libx264", "-preset", "medium", "-crf", "20", "-movflags", "+faststart", "-f", "mp4"});
  add({"file:" + partial.string()});
  return arguments;
}

/// The first line, which names the error; the others are its consequences.
std::string firstLine(const std::string& text) { return text.substr(0, std::min<std::size_t>(text.find('\n'), 300)); }

std::string endText(const std::optional<ChildEnd>& end) {
  return end && end->signal != 0 ? "ffmpeg was ended by signal " + std::to_string(end->signal) : "ffmpeg failed";
}

}  // namespace

std::optional<fs::path> findFfmpeg() {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder.empty() ? "." : folder) / "ffmpeg";
    std::error_code unreachable;  // then another folder may have it
    if (fs::is_regular_file(program, unreachable) && ::access(program.c_str(), X_OK) == 0) return program;
  }
  return std::nullopt;
}

void requireVideoName(const fs::path& file) {
  if (file.extension() == ".mp4" || isWebm(file)) return;
  throw UsageError("--video " + file.string() + ": must end in .mp4 or .webm");
}

VideoWriter::VideoWriter(const fs::path& file, const Format& format, const fs::path& ffmpeg,
                         const std::atomic<bool>& stop)
    : file_(file), partial_(file.string() + ".part"), size_(format.size), stop_(stop) {
  // A socket: writing to a pipe that ffmpeg has closed would end this process with SIGPIPE.
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw OutputError(file_.string() + ": cannot be written: " + std::strerror(errno));
  pictures_.emplace(ends[0]);
  const FileDescriptor theirs(ends[1]);
  std::vector<std::string> words = argumentsFor(partial_, isWebm(file_), format);
  words.insert(words.begin(), ffmpeg.string());
  process_.emplace(ChildCommand{.words = words, .input = theirs.number(), .output = words_.descriptor()});
}

VideoWriter::~VideoWriter() {
  process_.reset();
  std::error_code ignored;
  fs::remove(partial_, ignored);
}

void VideoWriter::fail(const std::string& what) {
  const std::string words = firstLine(words_.text());
  throw OutputError(file_.string() + ": cannot be written: " + what + (words.empty() ? "" : ": " + words));
}

void VideoWriter::write(const RgbImage& picture) {
  const ImageSize size{picture.width, picture.height};
  if (size != size_) fail("a picture has " + size.text() + " pixels, those before have " + size_.text());
  std::size_t sent = 0;
  auto until = Clock::now() + kPatience;
  while (sent < picture.pixels.size() && !stop_) {
    const ssize_t got = ::send(pictures_->number(), picture.pixels.data() + sent, picture.pixels.size() - sent,
                               MSG_NOSIGNAL | MSG_DONTWAIT);
    if (got > 0) {
      sent += static_cast<std::size_t>(got);
      until = Clock::now() + kPatience;
    } else if (errno == EPIPE || errno == ECONNRESET) {
      fail(endText(process_->wait(kLastWords)));
    } else if (errno != EAGAIN && errno != EINTR) {
      fail(std::strerror(errno));
    } else if (Clock::now() > until) {
      fail("ffmpeg takes no more pictures");
    } else {
      pollfd ready{.fd = pictures_->number(), .events = POLLOUT, .revents = 0};
      ::poll(&ready, 1, static_cast<int>(kStep.count()));
    }
  }
}

void VideoWriter::finish() {
  pictures_.reset();
  std::optional<ChildEnd> end;
  for (const auto until = Clock::now() + kPatience; !(end = process_->wait(kStep));) {
    if (stop_) return;
    if (Clock::now() > until) fail("ffmpeg does not end");
  }
  if (!end->good()) fail(endText(end));
  std::error_code error;
  fs::rename(partial_, file_, error);
  if (error) throw OutputError(file_.string() + ": cannot be written: " + error.message());
}

}  // namespace motorcade
