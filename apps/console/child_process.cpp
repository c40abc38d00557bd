#include "apps/console/child_process.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

constexpr int kCannotExecute = 127;  // as shells have it

/// All data that the child needs between fork and exec, where it may not allocate memory.
struct Prepared {
  std::vector<char*> words;
  const char* folder;
  int input, output;
  const cpu_set_t* processors;  // null for any
  pid_t parent;
};

FileDescriptor openLog(const std::filesystem::path& file) {
  FileDescriptor log(::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
  if (log.number() < 0) throw OutputError(file.string() + ": cannot be written: " + std::strerror(errno));
  return log;
}

[[noreturn]] void becomeProgram(const Prepared& prepared) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::signal(SIGXFSZ, SIG_DFL);
  if (prepared.processors != nullptr) ::sched_setaffinity(0, sizeof(cpu_set_t), prepared.processors);
  ::dup2(prepared.input < 0 ? ::open("/dev/null", O_RDONLY) : prepared.input, STDIN_FILENO);
  ::dup2(prepared.output, STDOUT_FILENO);
  ::dup2(prepared.output, STDERR_FILENO);
  if (::getppid() == prepared.parent && ::chdir(prepared.folder) == 0)
    ::execv(prepared.words.front(), prepared.words.data());
  const char* const problem = std::strerror(errno);
  const std::array<const char*, 4> texts{prepared.words.front(), ": cannot be executed: ", problem, "\n"};
  for (const char* const text : texts)
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) break;
  ::_exit(kCannotExecute);
}

double secondsOf(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

ChildEnd endOf(int status, const rusage& used) {
  constexpr std::int64_t kBytesPerUnit = 1024;
  return {.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 0,
          .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
          .cpu_s = secondsOf(used.ru_utime) + secondsOf(used.ru_stime),
          .peak_memory_bytes = used.ru_maxrss * kBytesPerUnit};
}

int startChild(const ChildCommand& command) {
  const FileDescriptor log = command.log.empty() ? FileDescriptor() : openLog(command.log);
  std::vector<std::string> words = command.words;
  cpu_set_t processors;
  CPU_ZERO(&processors);
  for (const int processor : command.processors) CPU_SET(static_cast<std::size_t>(processor), &processors);
  Prepared prepared{.words = {},
                    .folder = command.folder.empty() ? "." : command.folder.c_str(),
                    .input = command.input,
                    .output = command.log.empty() ? command.output : log.number(),
                    .processors = command.processors.empty() ? nullptr : &processors,
                    .parent = ::getpid()};
  for (std::string& word : words) prepared.words.push_back(word.data());
  prepared.words.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid == 0) becomeProgram(prepared);
  if (pid < 0) throw OutputError("no process can be started: " + std::string(std::strerror(errno)));
  ::setpgid(pid, pid);  // whoever is first
  return pid;
}

}  // namespace

ChildOutput::ChildOutput() : file_(::memfd_create("output", MFD_CLOEXEC)) {
  if (file_.number() < 0)
    throw OutputError("no memory for what a program prints: " + std::string(std::strerror(errno)));
}

std::string ChildOutput::text() const {
  std::string text;
  std::array<char, 4096> part;
  for (ssize_t got; (got = ::pread(descriptor(), part.data(), part.size(), std::ssize(text))) > 0;)
    text.append(part.data(), static_cast<std::size_t>(got));
  return text;
}

ChildProcess::ChildProcess(const ChildCommand& command)
    : pid_(startChild(command)), handle_(static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0))) {}

ChildProcess::~ChildProcess() {
  if (end_) return;
  signal(SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void ChildProcess::signal(int number) {
  if (!end_) ::kill(-pid_, number);
}

std::optional<ChildEnd> ChildProcess::wait(std::chrono::milliseconds patience) {
  if (end_) return end_;
  pollfd ended{.fd = handle_.number(), .events = POLLIN, .revents = 0};
  ::poll(&ended, 1, static_cast<int>(patience.count()));
  int status = 0;
  rusage used{};
  if (::wait4(pid_, &status, WNOHANG, &used) == pid_) end_ = endOf(status, used);
  return end_;
}

}  // namespace motorcade
