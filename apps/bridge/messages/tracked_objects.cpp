#include "apps/bridge/messages/tracked_objects.hpp"

#include <numbers>

#include "apps/bridge/messages/matrix_rows.hpp"
#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/object_box.hpp"
#include "apps/bridge/messages/object_kinds.hpp"
#include "apps/bridge/messages/object_uuid.hpp"

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

}  // namespace motorcade
