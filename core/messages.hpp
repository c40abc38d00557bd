#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/ids.hpp"
#include "core/image.hpp"
#include "core/instance_labels.hpp"
#include "core/pixel_mask.hpp"
#include "core/se3.hpp"
#include "core/timestamp.hpp"
#include "core/vehicle_motion.hpp"

/// The messages that pass between folders. Each is filled once by its stage and then only read.
namespace motorcade {

using SteadyTime = std::chrono::steady_clock::time_point;

/// Outcome of an input pair.
enum class FrameStatus {
  kGood,
  kLost,      // processed, but too few matches for an ego-motion: the pose is predicted
  kRejected,  // unreadable or of the wrong size: the pose is predicted
  kDropped,   // never processed, by the live policy: the pose is predicted
};

/// Cause of a status other than simply good. A good frame with a cause is *degraded*: measured, but less surely.
enum class FrameCause {
  kNone,
  kAfterGap,      // good: measured across frames that were missing or of no use
  kFewPoints,     // good: hardly more points than it takes
  kNothingFound,  // lost: hardly anything of the frames before is found in it, as when it is dark, blurred or frozen
  kUnlinked,      // lost: points are seen, but not how the camera moved since the last frame that was good
  kFailed,        // lost or rejected: a stage of the pipeline could not work
  kUnusable,      // rejected: damaged, missing or of the wrong size
  kOutOfOrder,    // rejected: its time does not follow that of the frame before
  kTooLate        // dropped: it never came, or not in time
};
inline constexpr std::size_t kCauseCount = 9;

/// Number, time and status of a message's frame. Each stage hands it on with its own findings.
struct FrameHead {
  FrameId frame;
  Timestamp stamp;
  FrameStatus status = FrameStatus::kGood;
  FrameCause cause = FrameCause::kNone;
  /// Counts up where no measurement links the frames before and after. Poses of different segments share a frame of
  /// reference by prediction alone.
  int segment = 0;
};

/// Optional inputs that come with a stereo pair's images.
struct FrameInputs {
  /// Useless pixels of the left image, such as those that show the own vehicle; null: none.
  std::shared_ptr<const PixelMask> ignored;
  /// Instance labels of the left image, of its size; null: nobody tells them.
  std::shared_ptr<const InstanceLabels> instances{};
  /// The vehicle's own motion, of which `vehicle_samples` were known when the pair came. Null: nothing tells it.
  std::shared_ptr<const VehicleMotionLog> vehicle_motion{};
  std::uint64_t vehicle_samples = 0;
  std::int64_t clock_ahead_ns = 0;  // from the camera's clock, which was set back, to the frames' time
};

/// A rectified stereo pair as it enters the pipeline.
struct StereoFrame {
  FrameHead head;
  SteadyTime due;     // when the pair was due; latency counts from here
  Image left, right;  // empty when rejected
  FrameInputs inputs;
  std::string problem;   // why the pair is rejected
  double decode_ms = 0;  // time spent on reading the images, before the pair was due
  SteadyTime decoded{};  // when they were read

  bool rejected() const { return head.status == FrameStatus::kRejected; }
  /// Gives up the images and the labels of their pixels.
  void reject(FrameCause cause, std::string why) {
    left = right = Image{};
    inputs.ignored.reset();
    inputs.instances.reset();
    head.status = FrameStatus::kRejected;
    head.cause = cause;
    problem = std::move(why);
  }
};
using StereoFramePtr = std::shared_ptr<const StereoFrame>;

/// Box in the left image, inclusive bounds [px].
struct Box {
  double left_px = 0, top_px = 0, right_px = 0, bottom_px = 0;
};

/// The part of the left image that shows what is fixed to the camera, as the own vehicle's hood.
struct OwnVehicleView {
  double share = 0;  // of the image
  Box box;
};

enum class ObjectState { kMoving, kStopped, kPredicted };

/// Kind of an object, as far as its size, height and speed tell.
enum class ObjectKind { kUnknown, kCar, kLargeVehicle, kTwoWheeler, kPedestrian };

/// The cuboid around an object, along its body's axes, with its bottom on the ground.
struct ObjectBox {
  Eigen::Vector3d center_body = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // length, width, height
  Eigen::Vector3d center_sigma_m = Eigen::Vector3d::Zero(), size_sigma_m = Eigen::Vector3d::Zero();
  ObjectKind kind = ObjectKind::kUnknown;
  double kind_probability = 0;
};

/// The pixels of the left image that show an object: `width` by `height` cells of `cell_px` pixels each way, the first
/// with its upper left corner at (left_px, top_px).
struct ObjectMask {
  TrackId track;
  int left_px = 0, top_px = 0, cell_px = 1, width = 0, height = 0;
  std::vector<std::uint8_t> inside;  // row by row, 1 where the cell shows the object
  bool at(int column, int row) const { return inside[static_cast<std::size_t>(row) * width + column] != 0; }
};

/// A followed point in one stereo pair: left pixel and disparity as measured, without any disparity offset.
struct PointMeasurement {
  PointId point;
  Eigen::Vector3f uvd_px;
  Eigen::Vector3f sigma_px;  // independent standard deviations of u, v, d
};

/// One frame's measurements of one object, relative to the camera of that frame.
struct ObjectObservation {
  TrackId track;
  FrameId frame;
  ObjectState state = ObjectState::kMoving;
  int points = 0;
  Box box;
  /// Pose of the object seen from the camera (encounter), right perturbation; only predicted when state is kPredicted.
  SE3 T_cam_body;
  Matrix6d encounter_covariance = Matrix6d::Identity();
  /// Motion since the object's previous observation, z_{i-1}^-1 * z_i, from points that the encounter did not use. Only
  /// back-ends measure it; the front-end leaves it empty.
  struct Motion {
    FrameId since;
    SE3 T_before_now;
    Matrix6d covariance;
  };
  std::optional<Motion> motion;
  /// Velocity of the body's origin relative to the world, in the camera's axes [m/s], by the front-end's measurement.
  Eigen::Vector3d velocity_cam_mps = Eigen::Vector3d::Zero();
  std::vector<PointMeasurement> measured;  // the body's points that agree with its motion, ordered by point
  std::vector<PointMeasurement> patches;   // the same of patches, which cover a body that may be a walking person
  bool born_slow = false;                  // the object was as slow and small as a person when it was spawned
  bool born_labelled = false;              // and all that an instance label showed had moved as one
};

/// Camera motion since the previous frame, identity in the first one. Unless the frame's status is kGood, it is
/// predicted, with a wide covariance.
struct Odometry {
  SE3 T_previous_now;
  Matrix6d covariance = Matrix6d::Identity();  // right perturbation
  /// The same motion without the images: by the vehicle's own sensors, if there are any that are believed. Else a frame
  /// that images do not link has the motion of a camera that stood, or drove steadily, just before. In a row of frames
  /// without another motion, the covariances of independent steps add up to that of the whole.
  struct Told {
    SE3 T_previous_now;
    Matrix6d covariance;
  };
  std::optional<Told> told{};
};

/// The findings about the sensors of the vehicle's own motion.
struct VehicleSensors {
  bool believed = true;            // they agree with the camera
  double speed_scale = 1;          // true over told speed
  double yaw_rate_bias_radps = 0;  // told minus true
  struct Motion {
    double speed_mps = 0, yaw_rate_radps = 0;
  };
  Motion told{}, seen{};  // by the sensors and by the camera, when they were compared last
};

/// Measurements of the front-end in one frame: all that the back-end needs.
struct FrameMeasurements {
  FrameHead head;
  Odometry odometry;
  /// Points at rest, and points not yet known to rest or to belong to an object; both ordered by point. Points of
  /// objects are in neither.
  std::vector<PointMeasurement> at_rest, undecided;
  /// True minus measured disparity, as the front-end assumes it.
  double disparity_offset_px = 0;
  /// Objects of this frame. A newly confirmed object brings its earlier observations along, oldest first, before the
  /// one of this frame.
  std::vector<ObjectObservation> objects;
  /// Tracks that ended: they get no further observation.
  std::vector<TrackId> ended;
  /// Part of the image that shows the own vehicle; nothing is measured there.
  std::optional<OwnVehicleView> own_vehicle{};
  std::optional<VehicleSensors> vehicle_sensors{};  // empty where there are none
};
using FrameMeasurementsPtr = std::shared_ptr<const FrameMeasurements>;

/// Rates of change of an object's speed and of its yaw rate.
struct ObjectAcceleration {
  double along_mps2 = 0, along_sigma_mps2 = 0;  // along its path: positive where it becomes faster
  double yaw_radps2 = 0, yaw_sigma_radps2 = 0;  // about the body's z axis
};

/// An object's estimate in one frame.
struct ObjectEstimate {
  TrackId track;
  ObjectState state = ObjectState::kMoving;
  SE3 T_world_body;
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  double speed_sigma_mps = 0;
  /// Covariance of the velocity, in the world's axes, as far as the camera tells: its own drift is not in it.
  std::optional<Eigen::Matrix3d> velocity_covariance{};
  double yaw_rate_radps = 0, yaw_rate_sigma_radps = 0;  // about the body's z axis
  /// Empty in the object's only frame, and from back-ends that cannot tell it.
  std::optional<ObjectAcceleration> acceleration{};
  int points = 0;
  Box box;
  std::optional<Matrix6d> covariance;  // of T_cam_body of the same frame
  std::optional<ObjectBox> cuboid{};
  double age_s = 0;  // since its first estimate of the same kind, online or final
  /// Probability that the body is there and moves, or moved before. An online estimate uses the frames up to its own, a
  /// final one all.
  double existence_probability = 1;
};

/// Number of frames that the covariance of a camera's motion spans, unless the caller asks for others. If the frame so
/// long before never entered, the motion begins at the last one before it that did.
inline constexpr int kCameraCovarianceFrames = 10;

/// Covariances of the camera in one frame, right perturbations; empty across what no measurement links.
struct CameraCovariances {
  std::optional<Matrix6d> motion;  // of T_cam(before)_cam(now), by default kCameraCovarianceFrames apart
  std::optional<Matrix6d> pose;    // of T_world_cam, relative to the frame that defines the world: grows with the way
};

/// The camera and the objects in one frame. An estimate is *online* as published for the newest frame, *settled* when
/// it is some seconds old, and *final* when it leaves the window.
struct FrameEstimate {
  FrameHead head;
  SE3 T_world_cam;
  CameraCovariances camera_covariances;
  std::vector<ObjectEstimate> objects;  // ordered by track
};

/// Cost and work of the back-end's updates, for reports and tests.
struct SolverCounters {
  std::int64_t updates = 0, relinearizations = 0, reorderings = 0, batch_solves = 0;
  std::int64_t variables = 0, factors = 0, retired_variables = 0;
  double chi2 = 0;
  /// True minus measured disparity, of back-ends that estimate it.
  double disparity_offset_px = 0, disparity_offset_sigma_px = 0;
  double disparity_shake_px = 0;  // standard deviation of what all disparities of a frame have in common
};

/// Standard deviation below which a shake can hardly be told from none.
inline constexpr double kLeastToldShake_px = 0.01;

/// The back-end's answer to one frame.
struct Estimates {
  FrameEstimate online;
  std::vector<FrameEstimate> finals;     // frames that left the window with this update, oldest first
  std::vector<FrameEstimate> settled{};  // oldest first; they come again as final
  SolverCounters counters;
  std::vector<std::string> problems{};  // sentences for the log: what was left out or dropped, and why
  std::vector<ObjectMask> masks{};      // of the online estimate's objects, those whose outline was looked for
};
using EstimatesPtr = std::shared_ptr<const Estimates>;

}  // namespace motorcade
