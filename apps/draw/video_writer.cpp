#include "apps/draw/video_writer.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds(120);  // with an ffmpeg that takes nothing, or does not end
constexpr auto kStep = std::chrono::milliseconds(50);

bool isWebm(const fs::path& file) { return file.extension() == ".webm"; }

/// Arguments of ffmpeg. The pictures are padded to even sides, which these formats require.
std::vector<std::string> argumentsFor(const fs::path& partial, bool webm, const VideoWriter::Format& format) {
  std::array<char, 32> rate;
  std::snprintf(rate.data(), rate.size(), "%.6f", format.rate_hz);
  std::vector<std::string> arguments{"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y"};
  const auto add = [&](std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  add({"-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", format.size.text(), "-framerate", rate.data()});
  add({"-i", "pipe:0", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"});
  if (webm)
    add({"-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-cpu-used", "4", "-row-mt", "1", "-f", "webm"});
  else
    add({"-c:v", "libx264", "-preset", "medium", "-crf", "20", "-movflags", "+faststart", "-f", "mp4"});
  add({"file:" + partial.string()});
  return arguments;
}

/// The first line, which names the error; the others are its consequences.
std::string firstLine(int descriptor) {
  std::array<char, 300> text;
  const ssize_t got = ::pread(descriptor, text.data(), text.size(), 0);
  const std::string_view all(text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, got)));
  return std::string(all.substr(0, all.find('\n')));
}

std::string endText(int status) {
  return WIFSIGNALED(status) ? "ffmpeg was ended by signal " + std::to_string(WTERMSIG(status)) : "ffmpeg failed";
}

/// Settings of a child process that differ from this one's.
class SpawnSettings {
 public:
  SpawnSettings() {
    posix_spawn_file_actions_init(&actions_);
    posix_spawnattr_init(&attributes_);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  void redirect(int from, int to) { posix_spawn_file_actions_adddup2(&actions_, from, to); }
  /// Starts the child in a group of its own, as this process handles Ctrl-C in a terminal, and without blocked signals.
  void separate() {
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  }
  /// Returns an error number, 0 when all is well.
  int spawn(pid_t& process, const fs::path& program, std::vector<std::string> arguments) const {
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    return posix_spawn(&process, program.c_str(), &actions_, &attributes_, pointers.data(), environ);
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

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
    : file_(file),
      partial_(file.string() + ".part"),
      size_(format.size),
      stop_(stop),
      words_(::memfd_create("ffmpeg", MFD_CLOEXEC)) {
  start(ffmpeg, format);
}

VideoWriter::~VideoWriter() {
  if (process_ > 0) {
    ::kill(-process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  std::error_code ignored;
  fs::remove(partial_, ignored);
}

/// Sends pictures over a socket. Writing to a pipe that ffmpeg has closed would end this process with SIGPIPE.
void VideoWriter::start(const fs::path& ffmpeg, const Format& format) {
  std::array<int, 2> ends{-1, -1};
  if (words_.number() < 0 || ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw OutputError(file_.string() + ": cannot be written: " + std::strerror(errno));
  pictures_.emplace(ends[0]);
  const FileDescriptor theirs(ends[1]);
  SpawnSettings settings;
  settings.redirect(theirs.number(), STDIN_FILENO);
  settings.redirect(words_.number(), STDOUT_FILENO);
  settings.redirect(words_.number(), STDERR_FILENO);
  settings.separate();
  const int error = settings.spawn(process_, ffmpeg, argumentsFor(partial_, isWebm(file_), format));
  if (error == 0) return;
  process_ = -1;
  throw OutputError(file_.string() + ": " + ffmpeg.string() + " cannot be started: " + std::strerror(error));
}

bool VideoWriter::hasEnded(int& status) {
  if (process_ > 0 && ::waitpid(process_, &status, WNOHANG) != process_) return false;
  process_ = -1;
  return true;
}

void VideoWriter::fail(const std::string& what) {
  const std::string words = firstLine(words_.number());
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
      int status = 0;
      for (int i = 0; i < 100 && !hasEnded(status); ++i)
        std::this_thread::sleep_for(kStep);  // its words may come later
      fail(endText(status));
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
  int status = 0;
  const auto until = Clock::now() + kPatience;
  while (!hasEnded(status)) {
    if (stop_) return;
    if (Clock::now() > until) fail("ffmpeg does not end");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail(endText(status));
  std::error_code error;
  fs::rename(partial_, file_, error);
  if (error) throw OutputError(file_.string() + ": cannot be written: " + error.message());
}

}  // namespace motorcade
