#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "apps/bridge/dds/dds_configuration.hpp"
#include "apps/bridge/messages/diagnostics.hpp"
#include "apps/bridge/messages/ros_messages.hpp"
#include "apps/bridge/messages/ros_objects.hpp"
#include "apps/bridge/messages/topics.hpp"

namespace motorcade {

/// Publishes messages as ROS 2 does by default: reliable, volatile, the last ten kept. A slow, stopped or absent
/// subscriber delays it by at most ten milliseconds per message. Such a subscriber misses messages, which are counted.
/// For one thread.
class DdsPublisher {
 public:
  struct Counts {
    std::string topic{};         // as ROS names it: /motorcade/pose
    std::int64_t published = 0;  // taken by DDS
    std::int64_t timed_out = 0;  // not taken in time
    std::int64_t overtaken = 0;  // left the history of ten before every subscriber acknowledged it: may be missing
    int subscribers = 0;         // now
  };
  /// Throws UsageError or OutputError.
  DdsPublisher(const DdsPlace& place, const std::set<Topic>& topics);
  /// Gives subscribers up to a second to acknowledge the last messages.
  ~DdsPublisher();
  DdsPublisher(const DdsPublisher&) = delete;
  DdsPublisher& operator=(const DdsPublisher&) = delete;

  /// False when a topic has fewer subscribers in the end, or when asked to stop.
  bool waitForSubscribers(int count, std::chrono::milliseconds patience, const std::stop_token& stop) const;

  /// True for the topics that it was made with; others must not be published.
  bool publishes(Topic topic) const;
  void publish(const ros::PoseStamped& message);
  void publish(const ros::Odometry& message);
  void publish(const ros::MarkerArray& message);
  void publish(const ros::TrackedObjects& message);
  void publish(const ros::Detection3DArray& message);
  void publish(const ros::DiagnosticArray& message);
  void publish(const ros::TransformStamped& message);

  /// The counts of its topics, in their order.
  std::vector<Counts> counts() const;
  /// True on loopback: nobody outside of this machine can send to it.
  bool isShielded() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace motorcade
