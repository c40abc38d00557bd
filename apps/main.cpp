#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "apps/command_line.hpp"
#include "io/errors.hpp"

namespace {

constexpr int kExitInternal = 70;

/// Runs the command and turns what went wrong into a message and an exit code.
int perform(const std::function<int()>& action) {
  try {
    return action();
  } catch (const motorcade::UserError& error) {
    spdlog::error(error.what());
    return error.exitCode();
  } catch (const std::bad_alloc&) {
    spdlog::error("out of memory");
  } catch (const std::exception& error) {
    spdlog::error("internal error: {}", error.what());
  }
  return kExitInternal;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow further is an error of the write, as on a full disk
  try {
    spdlog::set_default_logger(spdlog::stderr_color_mt("motorcade"));
    spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
    const motorcade::CommandLine command_line = motorcade::parseCommandLine(argc, argv);
    return command_line.action ? perform(command_line.action) : command_line.exit_code;
  } catch (...) {  // the logger itself, or the parser
    std::fputs("motorcade: internal error\n", stderr);
    return kExitInternal;
  }
}
