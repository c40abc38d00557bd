#pragma once

#include <string>

#include "core/se3.hpp"
#include "core/timestamp.hpp"

namespace google::protobuf {
class Descriptor;
class Timestamp;
}  // namespace google::protobuf
namespace foxglove {
class Color;
class Pose;
class Quaternion;
class Vector3;
}  // namespace foxglove

/// Fields that Foxglove's messages share.
namespace motorcade {

struct Color;

/// Frames of reference. `map` is `world` set upright: x ahead, y left and z up of the first left camera. The others are
/// those of the run folder, and one `object_N` per object.
inline constexpr const char* kMapFrame = "map";
inline constexpr const char* kWorldFrame = "world";
inline constexpr const char* kCameraFrame = "camera";
/// T_map_world
SE3 mapFromWorld();

void set(google::protobuf::Timestamp* message, Timestamp stamp);
void set(foxglove::Vector3* message, const Eigen::Vector3d& vector);
void set(foxglove::Quaternion* message, const Eigen::Matrix3d& rotation);
void set(foxglove::Pose* message, const SE3& pose);
void set(foxglove::Color* message, const Color& color, double opacity);

/// The serialized FileDescriptorSet of a message type's file and all its imports.
std::string descriptorsOf(const google::protobuf::Descriptor& type);

}  // namespace motorcade
