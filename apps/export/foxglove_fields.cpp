#include "apps/export/foxglove_fields.hpp"

#include <set>

#include <Eigen/Geometry>
#include <foxglove/Color.pb.h>
#include <foxglove/Pose.pb.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/timestamp.pb.h>

#include "apps/draw/palette.hpp"

namespace motorcade {
namespace {

namespace pb = google::protobuf;

/// Adds a file after the files that it imports.
void addFile(const pb::FileDescriptor& file, std::set<std::string>& added, pb::FileDescriptorSet& files) {
  if (!added.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) addFile(*file.dependency(i), added, files);
  file.CopyTo(files.add_file());
}

}  // namespace

SE3 mapFromWorld() {
  Eigen::Matrix3d map_world;
  map_world << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {map_world, Eigen::Vector3d::Zero()};
}

void set(pb::Timestamp* message, Timestamp stamp) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t rest_ns = (stamp.ns % kSecond_ns + kSecond_ns) % kSecond_ns;  // never negative
  message->set_seconds((stamp.ns - rest_ns) / kSecond_ns);
  message->set_nanos(static_cast<std::int32_t>(rest_ns));
}

void set(foxglove::Vector3* message, const Eigen::Vector3d& vector) {
  message->set_x(vector.x());
  message->set_y(vector.y());
  message->set_z(vector.z());
}

void set(foxglove::Quaternion* message, const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  message->set_x(q.x());
  message->set_y(q.y());
  message->set_z(q.z());
  message->set_w(q.w());
}

void set(foxglove::Pose* message, const SE3& pose) {
  set(message->mutable_position(), pose.translation());
  set(message->mutable_orientation(), pose.rotation());
}

void set(foxglove::Color* message, const Color& color, double opacity) {
  message->set_r(color.red / 255.0);
  message->set_g(color.green / 255.0);
  message->set_b(color.blue / 255.0);
  message->set_a(opacity);
}

std::string descriptorsOf(const pb::Descriptor& type) {
  pb::FileDescriptorSet files;
  std::set<std::string> added;
  addFile(*type.file(), added, files);
  return files.SerializeAsString();
}

}  // namespace motorcade
