#include "apps/bridge/bridge_command.hpp"
#include "apps/commands/command_options.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

void addWhere(CLI::App& command, BridgeOptions& options) {
  constexpr int kMostDomain = 232, kMostSubscribers = 1000;
  command.add_option("--domain", options.domain, "DDS domain; ROS 2's where it is given by the environment")
      ->envname("ROS_DOMAIN_ID")
      ->check(CLI::Range(0, kMostDomain))
      ->capture_default_str();
  typed(command, "ADDRESS", "--interface", options.interface,
        "IPv4 address or name of the network interface to send on; 127.0.0.1, this machine alone, when absent");
  typed(command, "N", "--wait-for-subscribers", options.subscribers,
        "Begin when each topic has so many subscribers, so that none misses the first message")
      ->check(CLI::Range(0, kMostSubscribers));
  command.add_option("--wait-at-most", options.patience_s, "And begin without them after so long [s]")
      ->check(CLI::Range(0.0, 86'400.0))
      ->capture_default_str();
}

void addWhat(CLI::App& command, BridgeOptions& options) {
  typed(command, "NAMES", "--topics", options.topics,
        "What to publish, with commas between: pose (geometry_msgs/PoseStamped), odometry (nav_msgs/Odometry), "
        "markers (visualization_msgs/MarkerArray), tracked_objects (autoware_perception_msgs/TrackedObjects), "
        "detections (vision_msgs/Detection3DArray), diagnostics (diagnostic_msgs/DiagnosticArray), tf "
        "(tf2_msgs/TFMessage)")
      ->capture_default_str();
  typed(command, "X,Y,Z,ROLL,PITCH,YAW", "--mounting", options.mounting,
        "Where the left camera sits in the vehicle's frame (x ahead, y left, z up) [m], and its turn about "
        "these axes, roll first [deg]: then the vehicle's pose, motion and view are published");
  typed(command, "WORLD,CHILD", "--frame-ids", options.frame_ids,
        "Names of the frames: the world, in which poses stand, and what moves in it; odom,camera when absent, "
        "odom,base_link with --mounting");
}

/// Adds the options for topics that are followed in place of a drive.
void addImages(CLI::App& command, BridgeOptions& options, CLI::Option* drive) {
  constexpr double kLeastWithin_ms = 1e-3, kMostWithin_ms = 1000;
  CLI::Option* const images =
      typed(command, "LEFT,RIGHT", "--images", options.images,
            "Follow these topics in place of a drive, sensor_msgs/Image or, where the name ends in "
            "/compressed, sensor_msgs/CompressedImage; the cameras are those of the camera_info beside them")
          ->excludes(drive);
  command
      .add_option("--pair-within", options.pair_within_ms,
                  "Images whose stamps are no further apart are a pair; less than half the cameras' period [ms]")
      ->needs(images)
      ->check(CLI::Range(kLeastWithin_ms, kMostWithin_ms))
      ->capture_default_str();
  typed(command, "TOPIC", "--vehicle-motion", options.vehicle_motion,
        "Where the vehicle's own motion comes, a geometry_msgs/TwistWithCovarianceStamped of the rear axle's "
        "middle: it leads the camera where images fail")
      ->needs(images);
  command.add_option("--pairs", options.pairs, "End after so many pairs; without, at SIGINT or SIGTERM")
      ->needs(images)
      ->check(CLI::PositiveNumber);
  command
      .add_flag("--every-pair", options.every_pair,
                "Lose no pair, for replays: subscribe reliably and hold the publisher up; without, the newest pair "
                "wins")
      ->needs(images);
  CLI::Option* const camera =
      typed(command, "FX,FY,CX,CY,BASELINE", "--camera", options.given.camera,
            "The cameras of a rectified pair, in pixels and, the last, meters, in place of camera_info")
          ->needs(images);
  typed(command, "FILE[,FILE]", "--calibration", options.given.calibration,
        "Calibration of the pair in place of camera_info, in any form that run reads")
      ->needs(images)
      ->excludes(camera);
  typed(command, "RGGB|BGGR|GRBG|GBRG", "--bayer", options.given.bayer,
        "Images that do not tell it are the mosaic of a color sensor: the filters of the first two pixels of "
        "the first two rows")
      ->needs(images);
}

void addPace(CLI::App& command, BridgeOptions& options, CLI::Option* drive) {
  command
      .add_option("--rate", options.rate,
                  "Pace of the replay in pairs per second, or max; that of the capture when absent")
      ->needs(drive);
  command
      .add_flag("--live", options.live,
                "Behave like a camera that does not wait: the newest pair wins, others are dropped")
      ->needs(drive);
  command.add_flag("--loop", options.loop, "Begin anew at the drive's end, until SIGINT or SIGTERM")->needs(drive);
}

/// Throws UsageError where there is nothing to follow.
int runChecked(const BridgeOptions& options) {
  if (options.drive.empty() && options.images.empty())
    throw UsageError("bridge: give the folder of a DRIVE, or the topics of two cameras by --images LEFT,RIGHT");
  return runBridge(options);
}

}  // namespace

void addBridge(CLI::App& app, Action& action) {
  const auto [command, options] =
      addCommand(app, action, "bridge", "Follow a recorded drive, or cameras, and publish the results as ROS 2 topics",
                 runChecked);
  CLI::Option* const drive = command.add_option("DRIVE", options.drive, "Folder of a sequence, as for run");
  addImages(command, options, drive);
  addWhat(command, options);
  addPace(command, options, drive);
  command.add_option("--threads", options.threads, "Workers of the pipeline")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  typed(command, "FILE.toml", "--config", options.config, "Parameters; see effective_config.toml of any run");
  addWhere(command, options);
  command.footer(
      "Examples: motorcade bridge DRIVE --loop\n"
      "          motorcade bridge --images /left/image_raw,/right/image_raw");
}

}  // namespace motorcade
