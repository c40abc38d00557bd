#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "apps/bridge/messages/topics.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// The command line of `motorcade bridge`, as the user typed it.
struct BridgeOptions {
  std::filesystem::path drive{}, config{};
  std::string rate{};  // `max`, HZ, or empty for the drive's own pace
  bool live = false, loop = false;
  std::string images{};          // LEFT,RIGHT: topics that are followed instead of a drive
  std::string vehicle_motion{};  // topic; empty: none
  bool every_pair = false;       // of them: no pair is lost
  double pair_within_ms = 5;
  std::int64_t pairs = 0;  // after which it ends; 0: there is no end
  GivenCameras given{};    // where no camera_info comes
  int threads = 2;
  int domain = 0;
  std::string interface {};  // empty: loopback
  std::string topics = kDefaultTopics;
  std::string mounting{};   // X,Y,Z,ROLL,PITCH,YAW; empty: the camera stands for the vehicle
  std::string frame_ids{};  // WORLD,CHILD; empty: by the mounting
  int subscribers = 0;      // to wait for, of each topic
  double patience_s = 30;   // at most so long
};

/// Follows a recorded drive, or topics with images, and publishes the results as ROS 2 topics; gives the exit code.
/// Failures are UserErrors.
int runBridge(const BridgeOptions& options);

/// Follows the topics of `--images` until a signal comes, or the wanted number of pairs. Returns the exit code;
/// failures are UserErrors.
int runTopicBridge(const BridgeOptions& options);

}  // namespace motorcade
