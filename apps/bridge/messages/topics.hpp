#pragma once

#include <array>
#include <cstddef>
#include <set>
#include <string>

namespace motorcade {

/// The topics that can be published, in the order of a frame's messages.
enum class Topic { kPose, kOdometry, kMarkers, kTrackedObjects, kDetections, kDiagnostics, kTf };
inline constexpr std::size_t kTopicCount = 7;

struct TopicNames {
  const char* option;  // in --topics
  const char* ros;     // without the first slash
};
inline constexpr std::array<TopicNames, kTopicCount> kTopicNames{{{"pose", "motorcade/pose"},
                                                                  {"odometry", "motorcade/odometry"},
                                                                  {"markers", "motorcade/objects"},
                                                                  {"tracked_objects", "motorcade/tracked_objects"},
                                                                  {"detections", "motorcade/detections"},
                                                                  {"diagnostics", "diagnostics"},
                                                                  {"tf", "tf"}}};

/// All but tf: two publishers of one transform would contradict each other.
inline constexpr const char* kDefaultTopics = "pose,odometry,markers,tracked_objects,detections,diagnostics";

/// "/motorcade/pose, ... and /tf".
std::string rosNamesOf(const std::set<Topic>& topics);

/// The topics of names with commas between them. Throws UsageError, which names the known ones.
std::set<Topic> topicsOf(const std::string& names);

}  // namespace motorcade
