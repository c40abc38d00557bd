#pragma once

#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "apps/commands/command_line.hpp"

/// The common parts of commands.
namespace motorcade {

template <class Options>
struct AddedCommand {
  CLI::App& command;
  Options& options;  // live as long as the command
};

/// Adds a command; when the command line names it, `action` is to call `run`.
template <class Options>
AddedCommand<Options> addCommand(CLI::App& app, Action& action, const std::string& name, const std::string& purpose,
                                 int (*run)(const Options&)) {
  const auto options = std::make_shared<Options>();
  CLI::App& command = *app.add_subcommand(name, purpose);
  command.callback([options, run, &action] { action = [options, run] { return run(*options); }; });
  return {command, *options};
}

/// Adds an option whose value help texts name by `type`.
template <class Value>
CLI::Option* typed(CLI::App& command, const std::string& type, const std::string& names, Value& value,
                   const std::string& purpose) {
  return command.add_option(names, value, purpose)->type_name(type);
}

/// Adds the capture rate of a run's sequence.
inline void addFps(CLI::App& command, std::optional<double>& fps_hz) {
  command.add_option("--fps", fps_hz, "Capture rate where the sequence has no times [Hz]; the run's when absent")
      ->check(CLI::Range(0.001, 100'000.0));
}

}  // namespace motorcade
