#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// The values of the messages that the bridge publishes, as ROS 2 defines them (geometry_msgs, nav_msgs, tf2_msgs,
/// visualization_msgs). Fields that it leaves empty are missing. Lengths are meters, angles radians.
namespace motorcade::ros {

struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};

struct Header {
  Time stamp{};
  std::string frame_id{};
};

/// A point, too.
struct Vector3 {
  double x = 0, y = 0, z = 0;
};

struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};

struct Pose {
  Vector3 position{};
  Quaternion orientation{};
};

/// Covariance, row by row, of (x, y, z, rotation about x, about y, about z) along the axes of the value's frame.
using Covariance = std::array<double, 36>;

struct PoseStamped {
  Header header{};
  Pose pose{};
};

struct Odometry {
  Header header{};
  std::string child_frame_id{};
  Pose pose{};                    // in header.frame_id
  Covariance pose_covariance{};   // along the axes of header.frame_id
  Vector3 linear_mps{};           // in child_frame_id
  Vector3 angular_radps{};        // in child_frame_id
  Covariance twist_covariance{};  // along the axes of child_frame_id
};

/// The pose of child_frame_id in header.frame_id, as tf2 has it.
struct TransformStamped {
  Header header{};
  std::string child_frame_id{};
  Pose transform{};
};

struct Color {
  float r = 0, g = 0, b = 0, a = 1;
};

struct Marker {
  enum class Type : std::int32_t { kArrow = 0, kCube = 1, kText = 9 };
  enum class Action : std::int32_t { kAdd = 0, kDelete = 2, kDeleteAll = 3 };

  Header header{};
  std::string ns{};
  std::int32_t id = 0;  // unique within its namespace
  Type type = Type::kCube;
  Action action = Action::kAdd;
  Pose pose{};
  Vector3 scale{};  // of a cube: its size; of a text: z is its height; of an arrow: diameters of shaft and head
  Color color{};
  std::int64_t lifetime_ns = 0;
  std::vector<Vector3> points{};  // of an arrow: from, to
  std::string text{};
};

struct MarkerArray {
  std::vector<Marker> markers{};
};

}  // namespace motorcade::ros
