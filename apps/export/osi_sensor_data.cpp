#include "apps/export/osi_sensor_data.hpp"

#include <algorithm>
#include <cmath>

#include <osi3/osi_common.pb.h>
#include <osi3/osi_detectedobject.pb.h>
#include <osi3/osi_sensordata.pb.h>

#include "apps/export/foxglove_fields.hpp"
#include "core/object_place.hpp"

namespace motorcade {
namespace {

constexpr double kVertical = 1e-6;       // cosine of a pitch that is a right angle, for the angles themselves
constexpr double kLeastCosine = 8.7e-3;  // of the pitch, for their rates

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

/// The rates of roll, pitch and yaw of a rotation that turns with this rate about its own axes; none where the x axis
/// is vertical.
void setAngleRates(osi3::BaseMoving* message, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& turn_radps) {
  if (const auto J = eulerJacobian(eulerAngles_rad(rotation)))
    set(message->mutable_orientation_rate(), *J * turn_radps);
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

/// Standard deviations of roll, pitch and yaw of a rotation whose perturbation on the right has this covariance; none
/// where the x axis is vertical.
void setAngleErrors(osi3::BaseMoving* message, const Eigen::Matrix3d& rotation,
                    const Eigen::Matrix3d& turn_covariance) {
  if (const auto J = eulerJacobian(eulerAngles_rad(rotation)))
    set(message->mutable_orientation(), sigmasOf(*J * turn_covariance * J->transpose()));
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

using osi3::DetectedEntityHeader;

constexpr std::uint64_t kSensor = 1;  // the stereo camera is the only one

DetectedEntityHeader::DataQualifier qualifierOf(const FrameHead& head) {
  switch (head.status) {
    case FrameStatus::kGood:
      return head.cause == FrameCause::kNone ? DetectedEntityHeader::DATA_QUALIFIER_AVAILABLE
                                             : DetectedEntityHeader::DATA_QUALIFIER_AVAILABLE_REDUCED;
    case FrameStatus::kLost:
      return DetectedEntityHeader::DATA_QUALIFIER_AVAILABLE_REDUCED;
    case FrameStatus::kRejected:
    case FrameStatus::kDropped:
      return DetectedEntityHeader::DATA_QUALIFIER_NOT_AVAILABLE;
  }
  return DetectedEntityHeader::DATA_QUALIFIER_UNKNOWN;
}

void setTimes(osi3::SensorData& message, const FrameHead& head) {
  DetectedEntityHeader* const header = message.mutable_moving_object_header();
  for (osi3::Timestamp* time :
       {message.mutable_timestamp(), message.mutable_last_measurement_time(), header->mutable_measurement_time()})
    set(time, head.stamp);
  header->set_cycle_counter(static_cast<std::uint64_t>(head.frame.value));
  header->set_data_qualifier(qualifierOf(head));
}

/// The vehicle's motion in the world's axes, but for the rates of its angles.
void setMotion(osi3::BaseMoving* place, const Eigen::Matrix3d& R_world_vehicle, const Vector6d& twist,
               const Vector6d& change) {
  const Eigen::Vector3d v = twist.head<3>(), w = twist.tail<3>();
  set(place->mutable_velocity(), R_world_vehicle * v);
  set(place->mutable_acceleration(), R_world_vehicle * (change.head<3>() + w.cross(v)));
  setAngleRates(place, R_world_vehicle, w);
}

/// Sets the host's pose. With M = T_vehicle_sensor and the world of the first sensor it is
///   T_world_vehicle = M T_world_sensor M^-1,
/// and Ad(M) carries twists and perturbations along.
void setHost(osi3::SensorData& message, const SensedFrame& frame, const SE3& T_vehicle_sensor) {
  const SE3 T_sensor_cam = mapFromWorld();  // the first sensor's axes are the map's
  const SE3 T_vehicle_cam = T_vehicle_sensor * T_sensor_cam;
  const SE3 T_world_vehicle = T_vehicle_cam * frame.estimate.T_world_cam * T_vehicle_cam.inverse();
  const Eigen::Matrix3d& R = T_world_vehicle.rotation();
  osi3::BaseMoving* const place = message.mutable_host_vehicle_location();
  set(place, T_world_vehicle);
  const Matrix6d carried = T_vehicle_sensor.adjoint();
  if (frame.motion) setMotion(place, R, carried * frame.motion->twist, carried * frame.motion->change);
  const auto& pose_covariance = frame.estimate.camera_covariances.pose;
  if (!pose_covariance) return;
  const Matrix6d from_camera = T_vehicle_cam.adjoint();
  const Matrix6d covariance = from_camera * *pose_covariance * from_camera.transpose();
  osi3::BaseMoving* const rmse = message.mutable_host_vehicle_location_rmse();
  set(rmse->mutable_position(), sigmasOf(R * covariance.topLeftCorner<3, 3>() * R.transpose()));
  setAngleErrors(rmse, R, covariance.bottomRightCorner<3, 3>());
}

}  // namespace

Eigen::Vector3d eulerAngles_rad(const Eigen::Matrix3d& rotation) {
  const double pitch = std::asin(std::clamp(-rotation(2, 0), -1.0, 1.0));
  if (std::hypot(rotation(0, 0), rotation(1, 0)) < kVertical)
    return {0, pitch, std::atan2(-rotation(0, 1), rotation(1, 1))};
  return {std::atan2(rotation(2, 1), rotation(2, 2)), pitch, std::atan2(rotation(1, 0), rotation(0, 0))};
}

std::optional<Eigen::Matrix3d> eulerJacobian(const Eigen::Vector3d& angles_rad) {
  const double sin_roll = std::sin(angles_rad[0]), cos_roll = std::cos(angles_rad[0]);
  const double sin_pitch = std::sin(angles_rad[1]), cos_pitch = std::cos(angles_rad[1]);
  if (cos_pitch < kLeastCosine) return std::nullopt;
  Eigen::Matrix3d J;
  J << 1, sin_roll * sin_pitch / cos_pitch, cos_roll * sin_pitch / cos_pitch,  //
      0, cos_roll, -sin_roll,                                                  //
      0, sin_roll / cos_pitch, cos_roll / cos_pitch;
  return J;
}

void set(osi3::Timestamp* message, Timestamp stamp) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t rest_ns = (stamp.ns % kSecond_ns + kSecond_ns) % kSecond_ns;  // never negative
  message->set_seconds((stamp.ns - rest_ns) / kSecond_ns);
  message->set_nanos(static_cast<std::uint32_t>(rest_ns));
}

void set(osi3::Vector3d* message, const Eigen::Vector3d& vector) {
  message->set_x(vector.x());
  message->set_y(vector.y());
  message->set_z(vector.z());
}

void set(osi3::Dimension3d* message, const Eigen::Vector3d& size_m) {
  message->set_length(size_m.x());
  message->set_width(size_m.y());
  message->set_height(size_m.z());
}

void set(osi3::Orientation3d* message, const Eigen::Vector3d& angles_rad) {
  message->set_roll(angles_rad[0]);
  message->set_pitch(angles_rad[1]);
  message->set_yaw(angles_rad[2]);
}

void set(osi3::BaseMoving* message, const SE3& T_parent_box) {
  set(message->mutable_position(), T_parent_box.translation());
  set(message->mutable_orientation(), eulerAngles_rad(T_parent_box.rotation()));
}

Eigen::Vector3d sigmasOf(const Eigen::Matrix3d& covariance) { return covariance.diagonal().cwiseMax(0).cwiseSqrt(); }

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

SE3 sensorPose(const SE3& T_world_cam) { return T_world_cam * mapFromWorld().inverse(); }

osi3::SensorData sensorData(const SensedFrame& frame, const std::optional<SE3>& T_vehicle_sensor) {
  osi3::SensorData message;
  message.mutable_version()->set_version_major(kOsiVersion.major);
  message.mutable_version()->set_version_minor(kOsiVersion.minor);
  message.mutable_version()->set_version_patch(kOsiVersion.patch);
  setTimes(message, frame.estimate.head);
  message.mutable_sensor_id()->set_value(kSensor);
  if (T_vehicle_sensor) {
    osi3::BaseMoving mounting;
    set(&mounting, *T_vehicle_sensor);
    *message.mutable_mounting_position()->mutable_position() = mounting.position();
    *message.mutable_mounting_position()->mutable_orientation() = mounting.orientation();
  }
  setHost(message, frame, T_vehicle_sensor.value_or(SE3()));
  const SE3 T_world_sensor = sensorPose(frame.estimate.T_world_cam);
  for (const ObjectEstimate& object : frame.estimate.objects)
    fill(*message.add_moving_object(), object, T_world_sensor, frame.motion);
  return message;
}

}  // namespace motorcade
