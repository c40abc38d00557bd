#include "apps/export/osi_sensor_data.hpp"

#include <osi3/osi_sensordata.pb.h>

#include "apps/export/foxglove_fields.hpp"
#include "apps/export/osi_fields.hpp"
#include "apps/export/osi_object.hpp"
#include "apps/export/osi_version.hpp"

namespace motorcade {
namespace {

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
