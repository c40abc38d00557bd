#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/commands/command_options.hpp"
#include "apps/draw/draw_command.hpp"
#include "apps/evaluate/report/report.hpp"
#include "apps/export/export_command.hpp"
#include "apps/latency/latency_report.hpp"
#include "apps/report/report_command.hpp"
#include "apps/view/recorded_view.hpp"

namespace motorcade {
namespace {

constexpr std::array kTruths{std::pair("position", OxtsTimes::kInterpolated),
                             std::pair("uninterpolated", OxtsTimes::kUninterpolated),
                             std::pair("velocity", OxtsTimes::kVelocities)};

void addTruth(CLI::App& command, EvaluateOptions& options) {
  std::vector<std::string> names;
  for (const auto& [name, truth] : kTruths) names.emplace_back(name);
  const auto choose = [&options](const std::string& chosen) {
    for (const auto& [name, truth] : kTruths)
      if (chosen == name) options.truth = truth;
  };
  CLI::Option* truth = command
                           .add_option_function<std::string>(
                               "--truth", choose,
                               "The true path of the camera: by `position` (poses.txt, else oxts), `uninterpolated` "
                               "(oxts packet k for image k, as published evaluations have it) or by the `velocity` of "
                               "oxts, added up")
                           ->check(CLI::IsMember(names));
  command
      .add_flag_callback(
          "--uninterpolated", [&options] { options.truth = OxtsTimes::kUninterpolated; },
          "The same as --truth uninterpolated")
      ->excludes(truth);
}

}  // namespace

void addEvaluate(CLI::App& app, Action& action) {
  const auto [command, options] =
      addCommand(app, action, "evaluate", "Measure a run against the ground truth of its sequence", runEvaluate);
  command.add_option("run", options.run, "Run folder")->required();
  command.add_option("--sequence", options.sequence, "The sequence that was run, where it is no longer where it was");
  addFps(command, options.fps_hz);
  command.add_option("--baseline", options.baseline,
                     "Another camera trajectory, as KITTI pose lines or in TUM form, for the relative error");
  command.add_option("--baseline-run", options.baseline_run,
                     "Run folder of another method, for the relative error of the objects");
  command.add_option("--half-run", options.half_run,
                     "Run folder of the same drive from the other half of the points: do the two differ as their "
                     "covariances say");
  command.add_option("--export-truth", options.export_truth, "Folder for the true trajectories of camera and objects");
  command.add_option("--export-kitti", options.export_kitti,
                     "Folder for the run's objects as KITTI tracking results; needs no ground truth");
  command.add_option("--json", options.json, "File for all measures as JSON");
  addTruth(command, options);
  command.footer("Example: motorcade evaluate RUN --json MEASURES.json");
}

void addDraw(CLI::App& app, Action& action) {
  const auto options = std::make_shared<DrawOptions>();
  const auto frames = std::make_shared<std::string>(":");
  CLI::App* command = app.add_subcommand("draw", "Draw a run: the annotated left images above a view from the top");
  command->add_option("run", options->run, "Run folder")->required();
  command->add_option("--sequence", options->sequence, "The sequence that was run, where it is no longer where it was");
  command->add_option("--out", options->out, "Folder for the pictures");
  typed(*command, "FILE", "--video", options->video,
        "File for a video, .mp4 or .webm, made by ffmpeg; pictures where that is not installed");
  command->add_option("--frames", *frames, "Frames A:B of the sequence");
  command->add_option("--every", options->every, "Draw every Nth frame")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  addFps(*command, options->fps_hz);
  command->footer("Example: motorcade draw RUN --video DRIVE.mp4");
  command->callback([options, frames, &action] {
    action = [options, frames] {
      options->frames = parseFrameRange(*frames);
      return runDraw(*options);
    };
  });
}

void addReport(CLI::App& app, Action& action) {
  const auto [command, options] =
      addCommand(app, action, "report", "Write a page that tells of a run, in one file", runReport);
  command.add_option("run", options.run, "Run folder")->required();
  command.add_option("--out", options.out, "File to write; report.html in the run folder when absent");
  command.add_option("--sequence", options.sequence, "The sequence that was run, where it is no longer where it was");
  addFps(command, options.fps_hz);
  command.add_option("--baseline", options.baseline,
                     "Another camera trajectory, as KITTI pose lines or in TUM form, to compare with");
  command.footer("Example: motorcade report RUN");
}

void addLatency(CLI::App& app, Action& action) {
  const auto [command, options] =
      addCommand(app, action, "latency", "Tell where the time of a run's frames went", runLatency);
  command.add_option("run", options.run, "Run folder")->required();
  command.add_option("--json", options.json, "File for the same as JSON");
  command.footer("Example: motorcade latency RUN");
}

void addExport(CLI::App& app, Action& action) {
  const auto [command, options] =
      addCommand(app, action, "export", "Write a run for other programs: Foxglove, Rerun, ASAM OSI, evo", runExport);
  command.add_option("run", options.run, "Run folder")->required();
  command.add_option("--sequence", options.sequence, "The sequence that was run, where it is no longer where it was");
  typed(command, "FILE", "--mcap", options.mcap,
        "MCAP file of images, poses, cuboids and points, for Foxglove and Rerun");
  typed(command, "FILE", "--osi", options.osi,
        "MCAP file of ASAM OSI: an osi3.SensorData per frame, as the rules for trace files want it");
  typed(command, "X,Y,Z,ROLL,PITCH,YAW", "--mounting", options.mounting,
        "For --osi: where the left camera sits in the vehicle's frame (x ahead, y left, z up) [m], and its "
        "turn about these axes, roll first [deg]");
  typed(command, "DIR", "--tum", options.tum, "Folder for trajectories: camera.tum, object_NNN.tum");
  command.add_flag("--predicted", options.with_predicted,
                   "Also poses in the trajectories that were predicted, not measured");
  addFps(command, options.fps_hz);
  command.footer("Example: motorcade export RUN --mcap RUN.mcap --tum TRAJECTORIES");
}

void addView(CLI::App& app, Action& action) {
  const auto [command, options] =
      addCommand(app, action, "view", "Serve a page that shows a run: image, scene, objects and times", runView);
  command.add_option("run", options.run, "Run folder")->required();
  typed(command, "RUN", "--against", options.against, "Another run of the same drive, shown beside it frame by frame");
  command.add_option("--sequence", options.sequence, "The sequence that was run, where it is no longer where it was");
  addFps(command, options.fps_hz);
  typed(command, "ADDR:PORT", "--view", options.address, "Where the page is served; 127.0.0.1:8080 when absent");
  command.footer("Example: motorcade view RUN");
}

}  // namespace motorcade
