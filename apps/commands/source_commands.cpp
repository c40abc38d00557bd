#include "apps/commands/command_options.hpp"
#include "apps/solve/solve_command.hpp"
#include "apps/synth/synth_command.hpp"

namespace motorcade {

namespace {

constexpr double kMostCalibrationErrors = 5, kMostShake_px = 5;
constexpr double kMostRigOffset_px = 64;  // far beyond what a rectification can be off and a matcher can bridge

}  // namespace

void addSynth(CLI::App& app, Action& action) {
  const auto [command, options] =
      addCommand(app, action, "synth", "Render a stereo sequence with exact ground truth", runSynth);
  command.add_option("OUT", options.out, "folder to write")->required();
  command.add_option("--scene", options.scene, "which scene")->required()->check(CLI::IsMember(synthSceneNames()));
  command.add_option("--frames", options.frames, "number of frames; the scene's own length when absent")
      ->check(CLI::PositiveNumber);
  command.add_option("--seed", options.seed, "changes textures, colors, placement and, slightly, speeds")
      ->capture_default_str();
  command.add_option("--style", options.style, "how the scene is pictured; its truth is the same")
      ->check(CLI::IsMember(synthStyleNames()))
      ->capture_default_str();
  command.add_option("--size", options.size, "image size as WIDTHxHEIGHT; 1242x375 when absent");
  command.add_option("--threads", options.threads, "rendering threads; all processors when absent")
      ->check(CLI::PositiveNumber);
  command.add_flag("--without-movers", options.without_movers, "the same scene without its moving vehicles");
  const CLI::Range offsets(-kMostRigOffset_px, kMostRigOffset_px);
  command
      .add_option("--disparity-offset", options.rig_error.disparity_offset_px,
                  "true minus measured disparity, of a rig that is off by a constant: calib.txt stays as it is [px]")
      ->check(offsets);
  command
      .add_option("--row-offset", options.rig_error.row_offset_px,
                  "rows by which the right image's content lies too low; calib.txt stays as it is [px]")
      ->check(offsets);
  command
      .add_option("--calibration-errors", options.rig_error.calibration,
                  "constant errors of the calibration, drawn with the seed: their standard deviations, in those of the "
                  "configuration's section calibration; calib.txt stays as it is")
      ->check(CLI::Range(0.0, kMostCalibrationErrors));
  command
      .add_option("--shake", options.rig_error.shake_px,
                  "standard deviation of an error that all disparities of a pair share [px]")
      ->check(CLI::Range(0.0, kMostShake_px));
  command.add_flag(
      "--vehicle-motion", options.vehicle_motion,
      "write motion.csv, too: the car's speed and yaw rate by sensors with the faults of cheap ones, drawn "
      "with the seed");
  command.footer("Example: motorcade synth DRIVE --scene urban --seed 2");
}

void addSolve(CLI::App& app, Action& action) {
  const auto [command, options] = addCommand(
      app, action, "solve", "Smooth a pose graph in g2o form incrementally, one update per new pose", runSolve);
  command.add_option("graph", options.graph, "g2o file, of poses in the plane or in space")->required();
  command.add_option("--out", options.out, "g2o file for the optimized graph");
  command.add_option("--json", options.json, "File for times, chi2 and problems as JSON");
  command.add_option("--policy", options.policy, "fluid: relinearize what is off; every: a batch step every N updates")
      ->check(CLI::IsMember({"fluid", "every"}))
      ->capture_default_str();
  command.add_option("--every", options.batch_every_updates, "N of --policy every")->check(CLI::PositiveNumber);
  command.add_option("--budget", options.budget_scalars, "Scalars eliminated per update beyond what new edges ask for")
      ->check(CLI::PositiveNumber);
  command.add_option("--budget-ms", options.budget_ms, "Time of an update [ms]; what exceeds it waits for later ones")
      ->check(CLI::PositiveNumber);
  command.add_flag("--batch", options.at_once, "The batch solution: everything at once, until it converges");
  command.add_flag("--updates", options.every_update, "Write the times of every update to the JSON file too");
  command.footer("Example: motorcade solve GRAPH.g2o --out SOLVED.g2o");
}

}  // namespace motorcade
