#include "apps/command_line.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/check/check_command.hpp"
#include "apps/console/log.hpp"
#include "apps/console/versions.hpp"
#include "apps/draw/draw_command.hpp"
#include "apps/evaluate/evaluate_command.hpp"
#include "apps/inject/fault_spec.hpp"
#include "apps/run/run_command.hpp"
#include "apps/solve/solve_command.hpp"
#include "apps/synth/synth_command.hpp"
#include "core/edit_distance.hpp"

/// The only source that includes CLI11, which takes long to compile.
namespace motorcade {
namespace {

using Action = std::function<int()>;

constexpr int kExitUsage = 2;

void addRun(CLI::App& app, Action& action) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Follow the camera and the moving vehicles through a stereo sequence");
  command->add_option("SEQUENCE", options->sequence, "Folder of a plain, KITTI tracking, odometry or raw sequence")
      ->required();
  command->add_option("--out", options->out, "Folder for the results")->required();
  command->add_option("--rate", options->rate, "Pace of the replay in pairs per second, or max (the default)");
  command->add_option("--fps", options->fps_hz, "Capture rate of a sequence without times [Hz]")
      ->check(CLI::Range(0.001, 100'000.0))
      ->capture_default_str();
  command->add_flag("--live", options->live,
                    "Behave like a camera that does not wait: the newest pair wins, others are dropped");
  command->add_flag("--masks", options->masks,
                    "Write what the image shows of the objects: masks/NNNNNN.png, outlines.jsonl, object_points.csv");
  command->add_option("--threads", options->threads, "Workers of the pipeline; decoding ahead is extra");
  command->add_option("--frames", options->frames, "Only the frames from A up to, not including, B")->type_name("A:B");
  command
      ->add_option(
          "--camera", options->camera,
          "KITTI pose lines of another camera trajectory, one per frame of the sequence, for backend.kind filter, "
          "filter_map or pose_graph")
      ->type_name("POSES.txt");
  command->add_option("--config", options->config, "Parameters; see effective_config.toml of any run")
      ->type_name("FILE.toml");
  command->add_option("--set", options->assignments, "One parameter, as key=value; may come several times")
      ->type_name("KEY=VALUE");
  command
      ->add_option("--inject", options->inject,
                   "Faults on the way from the camera, to see what becomes of the results: "
                   "KIND[=VALUE][/left|/right][@A[:B[:STEP]]][~SHARE],... and seed=N, as black@20:23,noise=20~0.1\n" +
                       faultHelp())
      ->type_name("FAULTS");
  command->add_option("--require", options->require, "Exit with 5 when fewer frames are tracked")
      ->type_name("tracked=FRACTION");
  command->add_flag("--force", options->force,
                    "Replace a finished run, and go on where the input is found to be worthless");
  command->footer("Example: motorcade run DRIVE --out RUN --masks");
  command->callback([options, &action] { action = [options] { return runSequence(*options); }; });
}

void addCheck(CLI::App& app, Action& action) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand("check", "Look for what is wrong with a sequence's first twenty pairs");
  command->add_option("SEQUENCE", options->sequence, "Folder of a sequence, as for run")->required();
  command->add_option("--frames", options->frames, "Only the frames from A up to, not including, B")->type_name("A:B");
  command->add_option("--fps", options->fps_hz, "Capture rate of a sequence without times [Hz]")
      ->check(CLI::Range(0.001, 100'000.0))
      ->capture_default_str();
  command->add_option("--json", options->json, "File for what was measured and found as JSON");
  command->add_option("--inject", options->inject, "Faults, as for run, to see whether they are found")
      ->type_name("FAULTS");
  command->footer("Example: motorcade check DRIVE");
  command->callback([options, &action] { action = [options] { return runCheck(*options); }; });
}

constexpr double kMostRigOffset_px = 64;  // far beyond what a rectification can be off and a matcher can bridge

void addSynth(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SynthOptions>();
  CLI::App* command = app.add_subcommand("synth", "Render a stereo sequence with exact ground truth");
  command->add_option("OUT", options->out, "folder to write")->required();
  command->add_option("--scene", options->scene, "which scene")->required()->check(CLI::IsMember(synthSceneNames()));
  command->add_option("--frames", options->frames, "number of frames; the scene's own length when absent")
      ->check(CLI::PositiveNumber);
  command->add_option("--seed", options->seed, "changes textures, colors, placement and, slightly, speeds")
      ->capture_default_str();
  command->add_option("--size", options->size, "image size as WIDTHxHEIGHT; 1242x375 when absent");
  command->add_option("--threads", options->threads, "rendering threads; all processors when absent")
      ->check(CLI::PositiveNumber);
  command->add_flag("--without-movers", options->without_movers, "the same scene without its moving vehicles");
  const CLI::Range offsets(-kMostRigOffset_px, kMostRigOffset_px);
  command
      ->add_option("--disparity-offset", options->rig_error.disparity_offset_px,
                   "true minus measured disparity, of a rig that is off by a constant: calib.txt stays as it is [px]")
      ->check(offsets);
  command
      ->add_option("--row-offset", options->rig_error.row_offset_px,
                   "rows by which the right image's content lies too low; calib.txt stays as it is [px]")
      ->check(offsets);
  command->footer("Example: motorcade synth DRIVE --scene urban --seed 2");
  command->callback([options, &action] { action = [options] { return runSynth(*options); }; });
}

void addEvaluate(CLI::App& app, Action& action) {
  const auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = app.add_subcommand("evaluate", "Measure a run against the ground truth of its sequence");
  command->add_option("run", options->run, "Run folder")->required();
  command->add_option("--sequence", options->sequence, "The sequence that was run, where it is no longer where it was");
  command
      ->add_option("--fps", options->fps_hz, "Capture rate where the sequence has no times [Hz]; the run's when absent")
      ->check(CLI::Range(0.001, 100'000.0));
  command->add_option("--baseline", options->baseline,
                      "KITTI pose lines of another camera trajectory, for the relative error");
  command->add_option("--baseline-run", options->baseline_run,
                      "Run folder of another method, for the relative error of the objects");
  command->add_option("--half-run", options->half_run,
                      "Run folder of the same drive from the other half of the points: do the two differ as their "
                      "covariances say");
  command->add_option("--export-truth", options->export_truth,
                      "Folder for the true trajectories of camera and objects");
  command->add_option("--export-kitti", options->export_kitti,
                      "Folder for the run's objects as KITTI tracking results; needs no ground truth");
  command->add_option("--json", options->json, "File for all measures as JSON");
  command->add_flag("--uninterpolated", options->uninterpolated,
                    "Take oxts packet k for image k, as published evaluations do");
  command->footer("Example: motorcade evaluate RUN --json MEASURES.json");
  command->callback([options, &action] { action = [options] { return runEvaluate(*options); }; });
}

void addDraw(CLI::App& app, Action& action) {
  const auto options = std::make_shared<DrawOptions>();
  const auto frames = std::make_shared<std::string>(":");
  CLI::App* command = app.add_subcommand("draw", "Draw a run: the annotated left images above a view from the top");
  command->add_option("run", options->run, "Run folder")->required();
  command->add_option("--sequence", options->sequence, "The sequence that was run, where it is no longer where it was");
  command->add_option("--out", options->out, "Folder for the pictures")->required();
  command->add_option("--frames", *frames, "Frames A:B of the sequence");
  command->add_option("--every", options->every, "Draw every Nth frame")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--fps", options->fps_hz, "Capture rate where the sequence has no times [Hz]; the run's when absent")
      ->check(CLI::Range(0.001, 100'000.0));
  command->footer("Example: motorcade draw RUN --out PICTURES --every 10");
  command->callback([options, frames, &action] {
    action = [options, frames] {
      options->frames = parseFrameRange(*frames);
      return runDraw(*options);
    };
  });
}

void addSolve(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SolveOptions>();
  CLI::App* command =
      app.add_subcommand("solve", "Smooth a pose graph in g2o form incrementally, one update per new pose");
  command->add_option("graph", options->graph, "g2o file, of poses in the plane or in space")->required();
  command->add_option("--out", options->out, "g2o file for the optimized graph");
  command->add_option("--json", options->json, "File for times, chi2 and problems as JSON");
  command
      ->add_option("--policy", options->policy, "fluid: relinearize what is off; every: a batch step every N updates")
      ->check(CLI::IsMember({"fluid", "every"}))
      ->capture_default_str();
  command->add_option("--every", options->batch_every_updates, "N of --policy every")->check(CLI::PositiveNumber);
  command
      ->add_option("--budget", options->budget_scalars, "Scalars eliminated per update beyond what new edges ask for")
      ->check(CLI::PositiveNumber);
  command->add_flag("--batch", options->at_once, "The batch solution: everything at once, until it converges");
  command->add_flag("--updates", options->every_update, "Write the times of every update to the JSON file too");
  command->footer("Example: motorcade solve GRAPH.g2o --out SOLVED.g2o");
  command->callback([options, &action] { action = [options] { return runSolve(*options); }; });
}

void addHelp(CLI::App& app, std::optional<std::string>& asked) {
  const auto topic = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("help", "Tell what a command is for, as its --help does");
  command->add_option("COMMAND", *topic, "Which one; all of them when absent");
  command->footer("Example: motorcade help run");
  command->callback([topic, &asked] { asked = *topic; });
}

/// How much of the log the user wants to see.
struct Talk {
  bool quiet = false, verbose = false;
  std::string level;
};

/// To the program and to each command, so that they may stand before and behind its name.
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

/// What is wrong with a word that nothing expected.
std::string complaintAbout(const std::string& word, const CLI::App& app) {
  const auto commands = app.get_subcommands();
  if (word.starts_with('-') && word.find_first_not_of('-') != std::string::npos)
    return complaintAboutOption(word, commands.empty() ? app : *commands.front());
  return commands.empty() ? complaintAboutCommand(word, app) : "unexpected argument " + word;
}

/// Tells what is wrong with the command line. What nobody knows comes first: a misspelled option is what makes a
/// required one missing.
int fail(const CLI::App& app, const std::string& problem) {
  const auto commands = app.get_subcommands();
  const auto unknown = app.remaining(true);
  const std::string name = commands.empty() ? "motorcade" : "motorcade " + commands.front()->get_name();
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
  for (const auto add : {addRun, addCheck, addSynth, addEvaluate, addDraw, addSolve}) add(app, command_line.action);
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
