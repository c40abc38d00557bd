#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include <malloc.h>
#include <unistd.h>

#include "apps/commands/command_line.hpp"
#include "apps/console/log.hpp"
#include "core/instruction_set.hpp"
#include "io/files/errors.hpp"

namespace {

constexpr int kExitInternal = 70;

/// Ends the program with a message, without asking for memory: what was written so far is in its files.
[[noreturn]] void endWith(const char* message) {
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, message, std::strlen(message));
  ::_exit(kExitInternal);
}

/// Ends the program when operator new finds no memory. Any thread may be in the middle of its work: nothing is unwound.
[[noreturn]] void endWithoutMemory() { endWith("motorcade: out of memory\n"); }

/// Ends on an exception that nothing may throw here: oneTBB's, when a thread cannot be started.
[[noreturn]] void endWithCurrentException() {
  try {
    if (const auto current = std::current_exception()) std::rethrow_exception(current);
  } catch (const std::bad_alloc&) {
    endWithoutMemory();
  } catch (const std::exception& error) {
    const char* const what = error.what();
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, what, std::strlen(what));
    endWith(": internal error of motorcade\n");
  } catch (...) {
    endWith("motorcade: unknown exception\n");
  }
  endWith("motorcade: internal error\n");
}

/// Keeps one heap for all threads. glibc gives threads heaps of their own, and what one has free the others cannot use.
/// Stages allocate little, so they hardly wait for each other.
void shareHeap() {
#ifdef M_ARENA_MAX
  mallopt(M_ARENA_MAX, 1);
#endif
}

/// Chooses the kernels' instructions, which the environment may name.
void chooseKernels() {
  try {
    motorcade::chooseInstructions();
  } catch (const std::invalid_argument& error) {
    throw motorcade::UsageError(error.what());
  }
}

/// Runs the command and turns an exception into a message and an exit code.
int perform(const std::function<int()>& action) {
  try {
    return action();
  } catch (const motorcade::UserError& error) {
    motorcade::logError(error.what());
    return error.exitCode();
  } catch (const std::bad_alloc&) {
    motorcade::logError("out of memory");
  } catch (const std::system_error& error) {
    const bool no_thread = error.code() == std::errc::resource_unavailable_try_again;
    const std::string kind = no_thread ? "no thread can be started, out of memory" : "internal error";
    motorcade::logError(kind + ": " + error.what());
  } catch (const std::exception& error) {
    motorcade::logError(std::string("internal error: ") + error.what());
  }
  return kExitInternal;
}

}  // namespace

int main(int argc, char** argv) {
  shareHeap();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow further is an error of the write, as on a full disk
  std::set_new_handler(endWithoutMemory);
  std::set_terminate(endWithCurrentException);
  try {
    motorcade::startLog();
    return perform([&] {
      chooseKernels();
      const motorcade::CommandLine command_line = motorcade::parseCommandLine(argc, argv);
      return command_line.action ? command_line.action() : command_line.exit_code;
    });
  } catch (...) {  // the logger itself
    std::fputs("motorcade: internal error\n", stderr);
    return kExitInternal;
  }
}
