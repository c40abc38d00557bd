#include <memory>

#include "apps/check/check_command.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/inject/fault_spec.hpp"
#include "apps/run/run_command.hpp"
#include "io/bag/bag_reader.hpp"

namespace motorcade {
namespace {

constexpr const char* kSequenceHelp =
    "Folder of a sequence: KITTI (tracking, odometry, raw), KITTI-360, Virtual KITTI 2, EuRoC, Argoverse stereo, or "
    "two folders of "
    "images, left and right, with their calibration; or a list of images, a line LEFT RIGHT or STAMP LEFT RIGHT for "
    "each pair";
constexpr const char* kRunInputHelp =
    "; or a bag of ROS 2 (FILE.mcap, FILE.db3, or the folder of one), with --topics; or - for a stream of pictures on "
    "the standard input (YUV4MPEG2, which ffmpeg and GStreamer write)";

void addGivenCameras(CLI::App& command, GivenCameras& given) {
  CLI::Option* const camera = typed(command, "FX,FY,CX,CY,BASELINE", "--camera", given.camera,
                                    "The cameras of a rectified pair, in pixels and, the last, meters; "
                                    "comes before the sequence's own calibration");
  typed(command, "FILE[,FILE]", "--calibration", given.calibration,
        "Calibration of the pair, which is rectified on the way: Kalibr's camchain, OpenCV's intrinsics and "
        "extrinsics, ROS' camera_info of both, EuRoC's sensor.yaml of both, and others; KITTI's (*.txt) of a "
        "rectified pair; or the folder that it lies in")
      ->excludes(camera);
  typed(command, "RGGB|BGGR|GRBG|GBRG", "--bayer", given.bayer,
        "The images are the mosaic of a color sensor, as raw images are: the filters of the first two pixels "
        "of the first two rows");
}

void addPacking(CLI::App& command, RunOptions& options) {
  CLI::Option* const beside =
      command.add_flag("--side-by-side", options.side_by_side, "A picture of the stream shows left | right");
  command.add_flag("--over-under", options.over_under, "A picture of the stream shows left above right")
      ->excludes(beside);
}

void addTopics(CLI::App& command, RunOptions& options) {
  typed(command, "LEFT,RIGHT", "--topics", options.topics,
        "Topics of a bag's images, of sensor_msgs' (or foxglove's) images, compressed or not; without it, "
        "run lists those that "
        "there are. The calibration is that of the camera_info beside them, unless --camera or --calibration "
        "is given");
}

void addPace(CLI::App& command, RunOptions& options) {
  command.add_option("--rate", options.rate, "Pace of the replay in pairs per second, or max (the default)");
  command
      .add_option("--fps", options.fps_hz,
                  "Capture rate of a sequence without times [Hz]; of a stream, in place of what its header tells")
      ->check(CLI::Range(0.001, 100'000.0))
      ->default_str("10");
  command.add_flag("--live", options.live,
                   "Behave like a camera that does not wait: the newest pair wins, others are dropped");
}

/// Adds the input, its options, and the folder of the results. A bag's topics may be listed without such a folder.
void addInputAndFolder(CLI::App& command, RunOptions& options) {
  CLI::Option* const input =
      command.add_option("SEQUENCE", options.sequence, std::string(kSequenceHelp) + kRunInputHelp)->required();
  addPacking(command, options);
  addTopics(command, options);
  addGivenCameras(command, options.given);
  CLI::Option* const out = command.add_option("--out", options.out, "Folder for the results")->required();
  input->each([out](const std::string& path) { out->required(!isBag(path)); });
}

/// Adds the options for what a run writes and serves to be looked at, beside its folder of results.
void addWaysToSee(CLI::App& command, RunOptions& options) {
  command.add_flag("--masks", options.masks,
                   "Write what the image shows of the objects: masks/NNNNNN.png, outlines.jsonl, object_points.csv");
  typed(command, "FILE", "--mcap", options.mcap,
        "Write images, poses, cuboids and points to an MCAP file for Foxglove and Rerun, while the run goes on");
  typed(command, "[ADDR:PORT]", "--view", options.view,
        "Serve a page that follows the run, under http://127.0.0.1:8080/ unless told otherwise")
      ->expected(0, 1)
      ->default_str("");
}

/// Adds the options for knowledge that comes beside the images.
void addWhatComesBeside(CLI::App& command, RunOptions& options) {
  typed(command, "POSES.txt", "--camera-poses", options.camera_poses,
        "KITTI pose lines of another camera trajectory, one per frame of the sequence, for backend.kind filter, "
        "filter_map or pose_graph");
  typed(command, "FILE|none", "--vehicle-motion", options.vehicle_motion,
        "The vehicle's own motion, which predicts where images fail: time_s,speed_mps,yaw_rate_radps as CSV "
        "on the images' clock, or KITTI's oxts.txt; without it, motion.csv in the sequence's folder; 'none' "
        "leaves that out");
  typed(command, "FOLDER", "--instances", options.instances,
        "Instance labels of the left image, rectified, as a network tells them, one PNG for a frame or for "
        "some: NNNNNN.png, one number for the pixels of a body, 0 for none. They need not be right");
  typed(command, "SIDE=PIXELS|MASK.png", "--ignore", options.ignored,
        "Pixels of the left image, rectified, that are of no use: so many rows or columns at a side, as "
        "bottom=70 (top, left, right), or an image that is not black there; may come several times. What is "
        "fixed to the camera, as a hood, is found without it");
}

}  // namespace

void addRun(CLI::App& app, Action& action) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Follow the camera and the moving vehicles through a stereo sequence");
  addInputAndFolder(*command, *options);
  addPace(*command, *options);
  addWaysToSee(*command, *options);
  command->add_option("--threads", options->threads, "Workers of the pipeline; decoding ahead is extra");
  typed(*command, "A:B", "--frames", options->frames, "Only the frames from A up to, not including, B");
  addWhatComesBeside(*command, *options);
  typed(*command, "FILE.toml", "--config", options->config, "Parameters; see effective_config.toml of any run");
  typed(*command, "KEY=VALUE", "--set", options->assignments, "One parameter, as key=value; may come several times");
  typed(*command, "P", "--min-existence", options->min_existence,
        "Leave out rows of objects that are less likely there, from 0, which reports all, to 0.9; short for "
        "--set frontend.shapes.min_existence=P");
  typed(*command, "FAULTS", "--inject", options->inject,
        "Faults on the way from the camera, to see what becomes of the results: "
        "KIND[=VALUE][/left|/right][@A[:B[:STEP]]][~SHARE],... and seed=N, as black@20:23,noise=20~0.1\n" +
            faultHelp());
  typed(*command, "tracked=FRACTION", "--require", options->require, "Exit with 5 when fewer frames are tracked");
  command->add_flag("--force", options->force,
                    "Replace a finished run, and go on where the input is found to be worthless");
  command->footer("Example: motorcade run DRIVE --out RUN --masks");
  command->callback([options, command, &action] {
    options->shown = command->count("--view") > 0;  // checks of an option are not called where it has no value
    if (options->out.empty() && !options->topics.empty()) throw CLI::RequiredError("--out");
    action = [options] { return runSequence(*options); };
  });
}

void addCheck(CLI::App& app, Action& action) {
  const auto [command, options] =
      addCommand(app, action, "check", "Look for what is wrong with a sequence's first twenty pairs", runCheck);
  command.add_option("SEQUENCE", options.sequence, kSequenceHelp)->required();
  addGivenCameras(command, options.given);
  typed(command, "A:B", "--frames", options.frames, "Only the frames from A up to, not including, B");
  command.add_option("--fps", options.fps_hz, "Capture rate of a sequence without times [Hz]")
      ->check(CLI::Range(0.001, 100'000.0))
      ->capture_default_str();
  command.add_option("--json", options.json, "File for what was measured and found as JSON");
  typed(command, "FILE.html", "--page", options.page,
        "File for a page with pictures of the worst pairs and how to mend what is wrong");
  typed(command, "FAULTS", "--inject", options.inject, "Faults, as for run, to see whether they are found");
  command.footer("Example: motorcade check DRIVE --page CHECK.html");
}

}  // namespace motorcade
