#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/bridge/messages/ros_messages.hpp"

/// The values of messages about objects, as autoware_perception_msgs and vision_msgs define them. Fields that the
/// bridge leaves empty are missing.
namespace motorcade::ros {

using Uuid = std::array<std::uint8_t, 16>;

struct ObjectClassification {
  enum class Label : std::uint8_t { kUnknown = 0, kCar = 1, kTruck = 2, kBicycle = 6, kPedestrian = 7 };
  Label label = Label::kUnknown;
  float probability = 0;
};

/// An object whose shape is a bounding box, with the pose of the box' middle.
struct TrackedObject {
  enum class Orientation : std::uint8_t { kUnavailable = 0, kSignUnknown = 1, kAvailable = 2 };
  Uuid object_id{};
  float existence_probability = 0;
  std::vector<ObjectClassification> classification{};
  Pose pose{};
  Covariance pose_covariance{};             // along the axes of the array's frame
  Vector3 linear_mps{}, angular_radps{};    // over ground, along the object's own axes
  Covariance twist_covariance{};            // along the object's own axes, as the next
  Vector3 linear_mps2{}, angular_radps2{};  // along the object's own axes
  Covariance acceleration_covariance{};
  Orientation orientation = Orientation::kUnavailable;
  bool is_stationary = false;
  Vector3 dimensions_m{};  // length, width, height; 0 where they are not known
};

struct TrackedObjects {
  Header header{};
  std::vector<TrackedObject> objects{};
};

struct ObjectHypothesis {
  std::string class_id{};
  double score = 0;
  Pose pose{};
  Covariance covariance{};  // along the axes of the array's frame
};

struct Detection3D {
  std::vector<ObjectHypothesis> results{};
  Pose box_center{};
  Vector3 box_size_m{};  // 0 where it is not known
  std::string id{};
};

/// Each detection has the array's header.
struct Detection3DArray {
  Header header{};
  std::vector<Detection3D> detections{};
};

}  // namespace motorcade::ros
