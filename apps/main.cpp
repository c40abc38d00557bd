#include <exception>
#include <functional>
#include <new>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "apps/draw/draw_command.hpp"
#include "apps/evaluate/evaluate_command.hpp"
#include "apps/run/run_command.hpp"
#include "apps/solve/solve_command.hpp"
#include "apps/synth/synth_command.hpp"
#include "io/errors.hpp"

namespace {

constexpr int kExitUsage = 2, kExitInternal = 70;

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
  spdlog::set_default_logger(spdlog::stderr_color_mt("motorcade"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  CLI::App app("Follows a car's own path and the moving vehicles around it, from one stereo camera, in real time.",
               "motorcade");
  app.set_version_flag("--version", MOTORCADE_VERSION);
  app.require_subcommand(1);
  std::function<int()> action;
  motorcade::addRunCommand(app, action);
  motorcade::addSynthCommand(app, action);
  motorcade::addEvaluateCommand(app, action);
  motorcade::addDrawCommand(app, action);
  motorcade::addSolveCommand(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }
  return perform(action);
}
