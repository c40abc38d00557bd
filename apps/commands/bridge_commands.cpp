#include <memory>

#include <CLI/CLI.hpp>

#include "apps/bridge/bridge_command.hpp"
#include "apps/commands/commands.hpp"

namespace motorcade {
namespace {

void addWhere(CLI::App& command, BridgeOptions& options) {
  constexpr int kMostDomain = 232, kMostSubscribers = 1000;
  command.add_option("--domain", options.domain, "DDS domain; ROS 2's where it is given by the environment")
      ->envname("ROS_DOMAIN_ID")
      ->check(CLI::Range(0, kMostDomain))
      ->capture_default_str();
  command
      .add_option(
          "--interface", options.interface,
          "IPv4 address or name of the network interface to send on; 127.0.0.1, this machine alone, when absent")
      ->type_name("ADDRESS");
  command
      .add_option("--wait-for-subscribers", options.subscribers,
                  "Begin when each topic has so many subscribers, so that none misses the first message")
      ->type_name("N")
      ->check(CLI::Range(0, kMostSubscribers));
  command.add_option("--wait-at-most", options.patience_s, "And begin without them after so long [s]")
      ->check(CLI::Range(0.0, 86'400.0))
      ->capture_default_str();
}

void addWhat(CLI::App& command, BridgeOptions& options) {
  command
      .add_option(
          "--topics", options.topics,
          "What to publish, with commas between: pose (geometry_msgs/PoseStamped), odometry (nav_msgs/Odometry), "
          "markers (visualization_msgs/MarkerArray), tracked_objects (autoware_perception_msgs/TrackedObjects), "
          "detections (vision_msgs/Detection3DArray), diagnostics (diagnostic_msgs/DiagnosticArray), tf "
          "(tf2_msgs/TFMessage)")
      ->type_name("NAMES")
      ->capture_default_str();
  command
      .add_option("--mounting", options.mounting,
                  "Where the left camera sits in the vehicle's frame (x ahead, y left, z up) [m], and its turn about "
                  "these axes, roll first [deg]: then the vehicle's pose, motion and view are published")
      ->type_name("X,Y,Z,ROLL,PITCH,YAW");
  command
      .add_option(
          "--frame-ids", options.frame_ids,
          "Names of the frames: the world, in which poses stand, and what moves in it; odom,camera when absent, "
          "odom,base_link with --mounting")
      ->type_name("WORLD,CHILD");
}

}  // namespace

void addBridge(CLI::App& app, Action& action) {
  const auto options = std::make_shared<BridgeOptions>();
  CLI::App* command = app.add_subcommand("bridge", "Follow a recorded drive and publish the results as ROS 2 topics");
  command->add_option("DRIVE", options->drive, "Folder of a sequence, as for run")->required();
  addWhat(*command, *options);
  command->add_option("--rate", options->rate,
                      "Pace of the replay in pairs per second, or max; that of the capture when absent");
  command->add_flag("--live", options->live,
                    "Behave like a camera that does not wait: the newest pair wins, others are dropped");
  command->add_flag("--loop", options->loop, "Begin anew at the drive's end, until SIGINT or SIGTERM");
  command->add_option("--threads", options->threads, "Workers of the pipeline")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--config", options->config, "Parameters; see effective_config.toml of any run")
      ->type_name("FILE.toml");
  addWhere(*command, *options);
  command->footer("Example: motorcade bridge DRIVE --loop");
  command->callback([options, &action] { action = [options] { return runBridge(*options); }; });
}

}  // namespace motorcade
