#include "apps/export/osi_object.hpp"

#include <algorithm>

#include <osi3/osi_detectedobject.pb.h>

#include "apps/export/euler_angles.hpp"
#include "apps/export/osi_fields.hpp"
#include "apps/export/relative_motion.hpp"
#include "core/object_place.hpp"

namespace motorcade {
namespace {

using osi3::DetectedItemHeader;
using osi3::DetectedMovingObject;
using osi3::MovingObject;
using VehicleType = MovingObject::VehicleClassification;

void setTrack(DetectedItemHeader& header, const ObjectEstimate& object) {
  header.mutable_tracking_id()->set_value(static_cast<std::uint64_t>(object.track.value));
  header.set_existence_probability(object.existence_probability);
  header.set_age(object.age_s);
  header.set_measurement_state(object.state == ObjectState::kPredicted
                                   ? DetectedItemHeader::MEASUREMENT_STATE_PREDICTED
                                   : DetectedItemHeader::MEASUREMENT_STATE_MEASURED);
}

void setEstimate(osi3::BaseMoving* base, const ObjectEstimate& object, const RelativeMotion& motion, bool moves) {
  if (object.cuboid) set(base->mutable_dimension(), object.cuboid->size_m);
  set(base, motion.T_sensor_box);
  if (!moves) return;
  set(base->mutable_velocity(), motion.velocity_mps);
  if (motion.acceleration_mps2) set(base->mutable_acceleration(), *motion.acceleration_mps2);
  setAngleRates(base, motion.T_sensor_box.rotation(), motion.turn_radps);
}

/// Covariance of the object's velocity: along it from that of the speed, across it from that of the heading.
Eigen::Matrix3d velocityCovariance(const ObjectEstimate& object, double heading_sigma_rad) {
  const Eigen::Vector3d along = directionOf(object);
  const Eigen::Vector3d across = object.T_world_body.rotation().col(2).cross(object.velocity_world_mps);
  return object.speed_sigma_mps * object.speed_sigma_mps * along * along.transpose() +
         heading_sigma_rad * heading_sigma_rad * across * across.transpose();
}

/// Sets the object's own errors. The sensor's errors are left out: they move all objects alike.
void setRmse(osi3::BaseMoving* rmse, const ObjectEstimate& object, const Eigen::Matrix3d& R_sensor_world, bool moves) {
  const Eigen::Matrix3d R_sensor_box = R_sensor_world * object.T_world_body.rotation();
  const auto inSensor = [&](const Eigen::Matrix3d& covariance) {
    return sigmasOf(R_sensor_world * covariance * R_sensor_world.transpose());
  };
  const ObjectPlace place = placeOf(object);
  if (object.cuboid) set(rmse->mutable_dimension(), object.cuboid->size_sigma_m);
  if (object.covariance) {
    set(rmse->mutable_position(), inSensor(place.center_covariance));
    setAngleErrors(rmse, R_sensor_box, object.covariance->bottomRightCorner<3, 3>());
  }
  if (!moves) return;
  set(rmse->mutable_velocity(), inSensor(velocityCovariance(object, place.heading_sigma_rad)));
  if (const auto& acceleration = object.acceleration)
    set(rmse->mutable_acceleration(),
        acceleration->along_sigma_mps2 * (R_sensor_world * directionOf(object)).cwiseAbs());
  if (const auto J = eulerJacobian(eulerAngles_rad(R_sensor_box)))
    set(rmse->mutable_orientation_rate(), object.yaw_rate_sigma_radps * J->col(2).cwiseAbs());
}

void addCandidate(DetectedMovingObject& message, double probability, MovingObject::Type type) {
  DetectedMovingObject::CandidateMovingObject* const candidate = message.add_candidate();
  candidate->set_probability(probability);
  candidate->set_type(type);
}

void addVehicle(DetectedMovingObject& message, double probability, VehicleType::Type type) {
  addCandidate(message, probability, MovingObject::TYPE_VEHICLE);
  message.mutable_candidate(message.candidate_size() - 1)->mutable_vehicle_classification()->set_type(type);
}

/// A person is assumed to face the walking direction.
void addPedestrian(DetectedMovingObject& message, double probability, const osi3::Orientation3d& facing) {
  addCandidate(message, probability, MovingObject::TYPE_PEDESTRIAN);
  *message.mutable_candidate(message.candidate_size() - 1)->mutable_upper_body_pose() = facing;
}

/// Adds candidates whose probabilities sum to 1: the kind, and an unknown object with the rest.
void addCandidates(DetectedMovingObject& message, const ObjectEstimate& object) {
  const ObjectKind kind = object.cuboid ? object.cuboid->kind : ObjectKind::kUnknown;
  const double told = object.cuboid ? std::clamp(object.cuboid->kind_probability, 0.0, 1.0) : 0;
  const double probability = kind == ObjectKind::kUnknown ? 0 : told;
  switch (kind) {
    case ObjectKind::kCar:
      addVehicle(message, probability, VehicleType::TYPE_CAR);
      break;
    case ObjectKind::kLargeVehicle:
      addVehicle(message, probability, VehicleType::TYPE_HEAVY_TRUCK);
      break;
    case ObjectKind::kTwoWheeler:  // its shape does not tell whether it has a motor
      addVehicle(message, probability / 2, VehicleType::TYPE_MOTORBIKE);
      addVehicle(message, probability / 2, VehicleType::TYPE_BICYCLE);
      break;
    case ObjectKind::kPedestrian:
      addPedestrian(message, probability, message.base().orientation());
      break;
    case ObjectKind::kUnknown:
      break;
  }
  if (probability < 1) addCandidate(message, 1 - probability, MovingObject::TYPE_UNKNOWN);
}

}  // namespace

void fill(osi3::DetectedMovingObject& message, const ObjectEstimate& object, const SE3& T_world_sensor,
          const std::optional<SensorMotion>& sensor) {
  const SE3 T_sensor_world = T_world_sensor.inverse();
  const RelativeMotion motion = relativeMotion(object, T_sensor_world, sensor.value_or(SensorMotion{}));
  setTrack(*message.mutable_header(), object);
  setEstimate(message.mutable_base(), object, motion, sensor.has_value());
  setRmse(message.mutable_base_rmse(), object, T_sensor_world.rotation(), sensor.has_value());
  if (object.state != ObjectState::kPredicted)
    message.set_movement_state(object.state == ObjectState::kMoving ? DetectedMovingObject::MOVEMENT_STATE_MOVING
                                                                    : DetectedMovingObject::MOVEMENT_STATE_STOPPED);
  addCandidates(message, object);
}

}  // namespace motorcade
