#include "apps/commands/command_line.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/console/log.hpp"
#include "apps/console/own_program.hpp"
#include "core/edit_distance.hpp"

namespace motorcade {
namespace {

constexpr int kExitUsage = 2;

void addHelp(CLI::App& app, std::optional<std::string>& asked) {
  const auto topic = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("help", "Tell what a command is for, as its --help does");
  command->add_option("COMMAND", *topic, "Which one; all of them when absent");
  command->footer("Example: motorcade help run");
  command->callback([topic, &asked] { asked = *topic; });
}

/// The user's choice of how much of the log is shown.
struct Talk {
  bool quiet = false, verbose = false;
  std::string level;
};

/// Adds the log's options to the program and to each command, so that they may stand before and behind the command's
/// name.
void addTalk(CLI::App& app, Talk& talk) {
  const auto names = logLevelNames();
  constexpr const char* kGroup = "Messages";
  app.add_flag("-q,--quiet", talk.quiet, "Only warnings and errors")->group(kGroup);
  app.add_flag("-v,--verbose", talk.verbose, "Details, too")->group(kGroup);
  app.add_option("--log-level", talk.level, "What is shown, from trace, which is all, to off")
      ->group(kGroup)
      ->type_name("LEVEL")
      ->check(CLI::IsMember(names));
}

/// False where two of them contradict each other.
bool applyTalk(const Talk& talk) {
  if (talk.quiet + talk.verbose + !talk.level.empty() > 1) return false;
  if (talk.quiet) setLogLevel("warning");
  if (talk.verbose) setLogLevel("debug");
  if (!talk.level.empty()) setLogLevel(talk.level);
  return true;
}

std::vector<std::string> longOptions(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  return names;
}

std::vector<std::string> commandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string suggestion(const std::string& nearest) { return nearest.empty() ? "" : "; did you mean " + nearest + "?"; }

std::string complaintAboutCommand(const std::string& name, const CLI::App& app) {
  return "unknown command " + name + suggestion(nearestName(name, commandNames(app)));
}

std::string complaintAboutOption(const std::string& word, const CLI::App& app) {
  const std::string name = word.substr(0, word.find('='));
  const std::string nearest = nearestName(name.substr(name.find_first_not_of('-')), longOptions(app));
  if (name == "--" + nearest) return name + " must stand behind the command's name";
  return "unknown option " + name + suggestion(nearest.empty() ? "" : "--" + nearest);
}

/// The command that was named, or the program itself. For a command with subcommands it is the one named behind it.
struct Named {
  const CLI::App* command;
  std::string name;  // with those before it
};
Named namedCommand(const CLI::App& app) {
  Named named{&app, app.get_name()};
  for (auto next = app.get_subcommands(); !next.empty(); next = named.command->get_subcommands())
    named = {next.front(), named.name + " " + next.front()->get_name()};
  return named;
}

/// Describes what is wrong with an unexpected word.
std::string complaintAbout(const std::string& word, const CLI::App& app) {
  const CLI::App& command = *namedCommand(app).command;
  if (word.starts_with('-') && word.find_first_not_of('-') != std::string::npos)
    return complaintAboutOption(word, command);
  return &command == &app ? complaintAboutCommand(word, app) : "unexpected argument " + word;
}

/// Prints what is wrong with the command line. Unknown words come first, as a misspelled option is what makes a
/// required one missing.
int fail(const CLI::App& app, const std::string& problem) {
  const auto unknown = app.remaining(true);
  const std::string name = namedCommand(app).name;
  std::cerr << name << ": " << (unknown.empty() ? problem : complaintAbout(unknown.front(), app)) << "\nSee " << name
            << " --help\n";
  return kExitUsage;
}

}  // namespace

CommandLine parseCommandLine(int argc, const char* const* argv) {
  CLI::App app("Follows a car's own path and the moving vehicles around it, from one stereo camera, in real time.",
               "motorcade");
  app.set_version_flag("--version", versionsText);
  app.require_subcommand(1);
  CommandLine command_line;
  for (const auto add : {addRun, addCheck, addSynth, addEvaluate, addDraw, addReport, addLatency, addExport, addView,
                         addSolve, addBatch})
    add(app, command_line.action);
#ifdef MOTORCADE_WITH_BRIDGE
  addBridge(app, command_line.action);
#endif
  std::optional<std::string> help;
  addHelp(app, help);
  Talk talk;
  addTalk(app, talk);
  for (CLI::App* command : app.get_subcommands({})) addTalk(*command, talk);
  const auto answered = [](int exit_code) { return CommandLine{.action = {}, .exit_code = exit_code}; };
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked = error.get_exit_code() == 0 && app.remaining().empty();  // for help or version
    return answered(asked ? app.exit(error) : fail(app, error.what()));
  }
  if (!applyTalk(talk)) return answered(fail(app, "give one of --quiet, --verbose and --log-level, not several"));
  if (!help) return command_line;
  const auto names = commandNames(app);
  if (!help->empty() && std::ranges::find(names, *help) == names.end())
    return answered(fail(app, complaintAboutCommand(*help, app)));
  const char* const as_option[] = {argv[0], help->empty() ? "--help" : help->c_str(), "--help"};
  return parseCommandLine(help->empty() ? 2 : 3, as_option);
}

}  // namespace motorcade
