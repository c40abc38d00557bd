#include "apps/bridge/messages/object_messages.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/object_fields.hpp"

namespace motorcade {
namespace {

using Label = ros::ObjectClassification::Label;
using Orientation = ros::TrackedObject::Orientation;

/// Largest standard deviation of a known heading. Three of them reach a right angle, so that ahead and astern differ.
constexpr double kMostHeadingSigma_rad = std::numbers::pi / 6;

enum Axis { kX, kY, kZ, kAboutX, kAboutY, kAboutZ };  // rows of twists and covariances

/// Label of a kind. The tracker does not distinguish trucks from buses, nor bicycles from motorcycles: these stand for
/// both.
Label labelOf(Result::Kind kind) {
  switch (kind) {
    case Result::Kind::kUnknown:
      return Label::kUnknown;
    case Result::Kind::kCar:
      return Label::kCar;
    case Result::Kind::kLargeVehicle:
      return Label::kTruck;
    case Result::Kind::kTwoWheeler:
      return Label::kBicycle;
    case Result::Kind::kPedestrian:
      return Label::kPedestrian;
  }
  return Label::kUnknown;
}

std::vector<ros::ObjectClassification> classificationOf(const Result::Object& object) {
  std::vector<ros::ObjectClassification> classification;
  for (const KindShare& share : kindShares(object))
    classification.push_back({.label = labelOf(share.kind), .probability = static_cast<float>(share.probability)});
  return classification;
}

Orientation orientationOf(const std::optional<Matrix6d>& covariance) {
  constexpr double kMostVariance = kMostHeadingSigma_rad * kMostHeadingSigma_rad;
  return covariance && (*covariance)(kAboutZ, kAboutZ) <= kMostVariance ? Orientation::kAvailable
                                                                        : Orientation::kUnavailable;
}

void setPose(const Result::Object& object, ros::TrackedObject& message) {
  const SE3 T_world_box = transformOf(object.T_world_body) * boxInBody(object);
  const auto covariance = boxCovariance(object);
  message.pose = poseOf(T_world_box);
  message.pose_covariance = covariance ? covarianceInParent(*covariance, T_world_box.rotation()) : unknownCovariance();
  message.orientation = orientationOf(covariance);
}

void setTwist(const Result::Object& object, ros::TrackedObject& message) {
  const auto [value, covariance] = twistOf(object);
  message.linear_mps = vectorOf(value.head<3>());
  message.angular_radps = vectorOf(value.tail<3>());
  message.twist_covariance = rowsOf<6>(covariance);
}

/// Sets the acceleration of the body's origin along its path, and that of its yaw rate.
void setAcceleration(const Result::Object& object, ros::TrackedObject& message) {
  Vector6d variances = Vector6d::Constant(kUnknownVariance);
  if (const auto& known = object.acceleration) {
    message.linear_mps2.x = known->along_mps2;
    message.angular_radps2.z = known->yaw_radps2;
    variances[kX] = known->along_sigma_mps2 * known->along_sigma_mps2;
    variances[kAboutZ] = known->yaw_sigma_radps2 * known->yaw_sigma_radps2;
  }
  message.acceleration_covariance = rowsOf<6>(Matrix6d(variances.asDiagonal()));
}

ros::TrackedObject trackedObjectOf(const Result::Object& object, std::int64_t first_stamp_ns) {
  const auto& [length_m, width_m, height_m] = object.box_size_m;
  ros::TrackedObject message;
  message.object_id = uuidOf(object.id, first_stamp_ns);
  message.existence_probability = static_cast<float>(object.existence_probability);
  message.classification = classificationOf(object);
  setPose(object, message);
  setTwist(object, message);
  setAcceleration(object, message);
  message.is_stationary = object.state == Result::State::kStopped;
  message.dimensions_m = {length_m, width_m, height_m};
  return message;
}

/// The kind's name in the column `kind` of a run's files.
const char* classIdOf(Result::Kind kind) {
  switch (kind) {
    case Result::Kind::kUnknown:
      return "unknown";
    case Result::Kind::kCar:
      return "car";
    case Result::Kind::kLargeVehicle:
      return "large_vehicle";
    case Result::Kind::kTwoWheeler:
      return "two_wheeler";
    case Result::Kind::kPedestrian:
      return "pedestrian";
  }
  return "unknown";
}

ros::Detection3D detectionOf(const Result::Object& object, std::int64_t first_stamp_ns) {
  const auto& [length_m, width_m, height_m] = object.box_size_m;
  const SE3 T_child_box = transformOf(object.T_cam_body) * boxInBody(object);
  const auto covariance = boxCovariance(object);
  ros::Detection3D detection;
  detection.box_center = poseOf(T_child_box);
  detection.box_size_m = {length_m, width_m, height_m};
  detection.id = textOf(uuidOf(object.id, first_stamp_ns));
  for (const KindShare& share : kindShares(object))
    detection.results.push_back(
        {.class_id = classIdOf(share.kind),
         .score = object.existence_probability * share.probability,
         .pose = detection.box_center,
         .covariance = covariance ? covarianceInParent(*covariance, T_child_box.rotation()) : unknownCovariance()});
  return detection;
}

constexpr double kTextHeight_m = 0.7, kTextAbove_m = 0.6;  // above the cuboid
constexpr double kShaft_m = 0.15, kHead_m = 0.35;          // diameters of an arrow
constexpr double kStanding_mps = 0.2;                      // slower, an arrow would be all head
constexpr float kOpaque = 1, kGlass = 0.6F, kFaint = 0.25F;

using Type = ros::Marker::Type;
using Action = ros::Marker::Action;

/// A marker's id of ROS, 32 bits. An id that is used again after 2^31 objects belonged to an object long gone.
std::int32_t markerId(std::int64_t object) {
  return static_cast<std::int32_t>(object & std::numeric_limits<std::int32_t>::max());
}

ros::Color colorOf(Result::State state) {
  switch (state) {
    case Result::State::kMoving:
      return {.r = 0.20F, .g = 0.75F, .b = 0.35F, .a = kGlass};
    case Result::State::kStopped:
      return {.r = 0.95F, .g = 0.65F, .b = 0.15F, .a = kGlass};
    case Result::State::kPredicted:
      return {.r = 0.60F, .g = 0.60F, .b = 0.65F, .a = kFaint};
  }
  return {};
}

ros::Color opaque(ros::Color color) {
  color.a = kOpaque;
  return color;
}

/// An object's cuboid in the world.
struct Placed {
  explicit Placed(const Result::Object& object)
      : T_world_box(transformOf(object.T_world_body) * boxInBody(object)),
        velocity_world_mps(vectorFrom(object.velocity_world_mps)) {}
  SE3 T_world_box;
  Eigen::Vector3d velocity_world_mps;
};

ros::Marker box(const Placed& placed, const Result::Object& object, ros::Marker marker) {
  const auto& [length_m, width_m, height_m] = object.box_size_m;
  marker.ns = "box";
  marker.type = Type::kCube;
  marker.pose = poseOf(placed.T_world_box);
  marker.scale = {length_m, width_m, height_m};
  marker.color = colorOf(object.state);
  return marker;
}

ros::Marker label(const Placed& placed, const Result::Object& object, ros::Marker marker) {
  const Eigen::Vector3d up(0, 0, object.box_size_m[2] / 2 + kTextAbove_m);
  marker.ns = "label";
  marker.type = Type::kText;
  marker.pose.position = vectorOf(placed.T_world_box * up);
  marker.scale.z = kTextHeight_m;
  marker.color = {.r = 1, .g = 1, .b = 1, .a = kOpaque};
  marker.text = fmt::format("{}: {:.1f} m/s", object.id, placed.velocity_world_mps.norm());
  return marker;
}

ros::Marker arrow(const Placed& placed, const Result::Object& object, ros::Marker marker) {
  const Eigen::Vector3d from = placed.T_world_box.translation();
  marker.ns = "velocity";
  marker.type = Type::kArrow;
  marker.scale = {kShaft_m, kHead_m, 0};
  marker.color = opaque(colorOf(object.state));
  marker.points = {vectorOf(from), vectorOf(Eigen::Vector3d(from + placed.velocity_world_mps))};
  return marker;
}

}  // namespace

ObjectTwist twistOf(const Result::Object& object) {
  const Eigen::Matrix3d R_body_world = transformOf(object.T_world_body).rotation().transpose();
  Eigen::Matrix<double, 6, 4> J = Eigen::Matrix<double, 6, 4>::Zero();
  J.topLeftCorner<3, 3>() = R_body_world;
  J.topRightCorner<3, 1>() = Eigen::Vector3d::UnitZ().cross(vectorFrom(object.box_center_body_m));
  J(kAboutZ, 3) = 1;
  Eigen::Vector4d motion;
  motion << vectorFrom(object.velocity_world_mps), object.yaw_rate_radps;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  covariance.topLeftCorner<3, 3>() = matrixOf<3>(object.velocity_covariance);
  covariance(3, 3) = object.yaw_rate_sigma_radps * object.yaw_rate_sigma_radps;
  ObjectTwist twist{.value = J * motion, .covariance = J * covariance * J.transpose()};
  twist.covariance(kAboutX, kAboutX) = twist.covariance(kAboutY, kAboutY) = kUnknownVariance;
  return twist;
}

ros::TrackedObjects trackedObjectsOf(const Result& result, const std::string& world, std::int64_t first_stamp_ns) {
  ros::TrackedObjects message{.header = headerOf(result, world), .objects = {}};
  for (const Result::Object& object : result.objects)
    message.objects.push_back(trackedObjectOf(object, first_stamp_ns));
  return message;
}

ros::Detection3DArray detectionsOf(const Result& result, const std::string& child, std::int64_t first_stamp_ns) {
  ros::Detection3DArray message{.header = headerOf(result, child), .detections = {}};
  for (const Result::Object& object : result.objects)
    if (object.state != Result::State::kPredicted) message.detections.push_back(detectionOf(object, first_stamp_ns));
  return message;
}

void ObjectMarkers::add(const Result::Object& object, const ros::Marker& common, ros::MarkerArray& array) const {
  const Placed placed(object);
  ros::Marker marker = common;
  marker.id = markerId(object.id);
  if (object.box_size_m[0] > 0) array.markers.push_back(box(placed, object, marker));
  array.markers.push_back(label(placed, object, marker));
  if (placed.velocity_world_mps.norm() >= kStanding_mps) array.markers.push_back(arrow(placed, object, marker));
}

void ObjectMarkers::deleteWhatVanished(ros::Marker common, ros::MarkerArray& array) {
  std::set<Key> gone = std::move(shown_);
  shown_.clear();
  for (const ros::Marker& marker : array.markers) {
    if (marker.action != Action::kAdd) continue;
    shown_.emplace(marker.ns, marker.id);
    gone.erase({marker.ns, marker.id});
  }
  common.action = Action::kDelete;
  for (const auto& [ns, id] : gone) {
    common.ns = ns;
    common.id = id;
    array.markers.push_back(common);
  }
}

ros::MarkerArray ObjectMarkers::operator()(const Result& result) {
  ros::Marker common;
  common.header = {.stamp = timeOf(result.stamp_ns), .frame_id = params_.frame_id};
  ros::MarkerArray array;
  if (!begun_) array.markers.push_back(common);
  if (!begun_) array.markers.back().action = Action::kDeleteAll;
  begun_ = true;
  ros::Marker lasting = common;
  lasting.lifetime_ns = std::llround(1e9 * params_.lifetime_s);
  for (const Result::Object& object : result.objects) add(object, lasting, array);
  deleteWhatVanished(common, array);
  return array;
}

}  // namespace motorcade
