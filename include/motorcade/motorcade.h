#pragma once

/// Motorcade in C: the interface of motorcade.hpp, which explains more, with handles, structs and codes.
///   motorcade_tracker_create(&camera, &options, &tracker);               // motorcade_last_error() says what is wrong
///   motorcade_tracker_push(tracker, &pair, &push);
///   while (motorcade_tracker_wait(tracker, 100, &result) == MOTORCADE_OK) motorcade_result_frame(result, &frame), ...
///
/// T_a_b takes coordinates in b to coordinates in a: three rows of four. cam is the left camera, rectified: x right,
/// y down, z ahead (MOTORCADE_AXES_REP103: x ahead, y left, z up); world is the cam of the first frame that shows
/// points; body is an object's: x as it traveled when it was confirmed, y left, z up. Covariances are row by row, of
/// perturbations (rho, phi) [m, rad] on the right, T exp(rho, phi). Units are in the names.
///
/// A struct begins with its size, which the caller sets: motorcade_frame frame = {.struct_size = sizeof frame};
/// Later versions append members. Those that an older program's struct lacks are not written, and have their default
/// when read; those that an older library does not know must be zero, the default where there is no `_init`. One thread
/// pushes, one takes results; any thread may make every other call. Arguments are read during the call alone. A call
/// that gives an error leaves structs as they were, and NULL where a handle was asked for.
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif
typedef struct motorcade_tracker motorcade_tracker;      // follows the camera and the objects
typedef struct motorcade_recording motorcade_recording;  // a recorded drive: KITTI, EuRoC, Argoverse or plain images
typedef struct motorcade_result motorcade_result;        // what is known in one frame; never changes, for any thread

typedef enum {
  MOTORCADE_OK = 0,
  MOTORCADE_NONE = 1,                // nothing to give: no result yet or in time, no mask
  MOTORCADE_DONE = 2,                // no further result will come; no further pair is recorded
  MOTORCADE_ERROR_VALUE = -1,        // what was asked for cannot be done: motorcade::Error
  MOTORCADE_ERROR_NULL = -2,         // a handle or pointer is NULL
  MOTORCADE_ERROR_STRUCT_SIZE = -3,  // not set, too small, or beyond it is what this library does not know
  MOTORCADE_ERROR_MEMORY = -4,       // there is no more
  MOTORCADE_ERROR_INTERNAL = -5      // a fault of the library
} motorcade_code;
/// The error of this thread's last call that failed: what is wrong and how to fix it, and the field, as
/// "camera.baseline_m". Never NULL; the text lives until the next such call.
const char* motorcade_last_error(void);
const char* motorcade_last_error_field(void);
const char* motorcade_version(void);  // as "0.1.0"
typedef enum { MOTORCADE_UNDISTORTED, MOTORCADE_RADIAL_TANGENTIAL, MOTORCADE_EQUIDISTANT } motorcade_distortion;
typedef struct {
  size_t struct_size;
  double fx_px, fy_px, cx_px, cy_px;
  motorcade_distortion distortion;
  double coefficients[8];  // k1 k2 p1 p2 k3 k4 k5 k6 as OpenCV orders them; equidistant: k1 k2 k3 k4
} motorcade_lens;
typedef struct {
  size_t struct_size;
  const motorcade_lens *left, *right;
  double T_right_left[12];
} motorcade_rig;
typedef struct {
  size_t struct_size;
  int width_px, height_px;                        // of the images that are pushed
  double fx_px, fy_px, cx_px, cy_px, baseline_m;  // rectified; not read where there is a rig
  const motorcade_rig* rig;                       // of a pair that is still to be rectified, which is done inside
  /// Useless pixels of the rectified left image: at its sides, and those of a mask that are not 0.
  int ignored_left_px, ignored_top_px, ignored_right_px, ignored_bottom_px;
  const uint8_t* ignored_mask;  // width_px x height_px, row by row; or NULL
  /// Standard deviations of the calibration, see motorcade.hpp; typical values where `has_sigmas` is false.
  bool has_sigmas;
  double sigma_focal, sigma_middle_px, sigma_distortion, sigma_baseline, sigma_disparity_px;
} motorcade_camera;
typedef enum { MOTORCADE_GRAY8, MOTORCADE_GRAY16, MOTORCADE_RGB8, MOTORCADE_BGR8 } motorcade_format;
typedef struct {
  size_t struct_size;
  const void* pixels;
  int width_px, height_px;
  motorcade_format format;  // gray is BT.601; 16 bits may use 10 to 14, see motorcade.hpp
  int64_t stride_bytes;     // from row to row; 0: rows without gaps
} motorcade_image;
typedef struct {
  size_t struct_size;
  const motorcade_image *left, *right;
  int64_t stamp_ns;                  // capture time, after that of the pair before
  int64_t frame;                     // number, from 0, after that of the pair before; -1, the default: the next one
  const motorcade_image* instances;  // which body each pixel of the left image shows, see motorcade.hpp; or NULL
} motorcade_pair;
motorcade_code motorcade_pair_init(motorcade_pair* pair);  // sets all but the size to the default
/// Live: the newest pair wins, push never waits. Replay: no pair is lost, push waits for room, results are repeatable.
typedef enum { MOTORCADE_POLICY_LIVE, MOTORCADE_POLICY_REPLAY } motorcade_policy;
typedef enum { MOTORCADE_AXES_OPTICAL, MOTORCADE_AXES_REP103 } motorcade_axes;
typedef enum { MOTORCADE_LOG_INFO, MOTORCADE_LOG_WARNING, MOTORCADE_LOG_ERROR } motorcade_log_level;
typedef struct {
  size_t struct_size;
  motorcade_policy policy;
  motorcade_axes axes;
  bool masks;
  int threads;            // 1 to 64, at most one per processor is used
  int realtime_priority;  // of its threads: 1 to 99 is SCHED_FIFO, which may need a privilege
  size_t cpu_count;
  const int* cpus;       // that its threads may run on; none: all
  int64_t patience_ms;   // replay: a push waits so long at most for results to be taken
  const char* settings;  // lines of a configuration file: "frontend.optical_flow.max_tracks = 1000"; or NULL
  void (*log)(motorcade_log_level level, const char* text, void* user);  // from its threads, several at once; or NULL
  void* log_user;
  int64_t covariance_frames;  // that motion_covariance reaches back: 1 to 60
} motorcade_options;
motorcade_code motorcade_options_init(motorcade_options* options);  // sets all but the size to the default
typedef enum { MOTORCADE_PUSH_ACCEPTED, MOTORCADE_PUSH_REPLACED, MOTORCADE_PUSH_REJECTED } motorcade_push_status;
typedef struct {
  size_t struct_size;
  motorcade_push_status status;  // replaced: accepted, and an older pair that still waited is dropped
  const char* why;               // it was rejected; static text
} motorcade_push;
typedef struct {
  size_t struct_size;
  int64_t pushed, rejected;  // by push; no result comes of a rejected pair
  int64_t dropped;           // replaced by a newer one
  int64_t results, untaken;  // given so far; lost since nobody took them (live: beyond 256)
} motorcade_counts;
/// Options may be NULL: all have their default.
motorcade_code motorcade_tracker_create(const motorcade_camera* camera, const motorcade_options* options,
                                        motorcade_tracker** tracker);
/// Abandons what is in flight, ends calls that wait in other threads, joins its own. Results that were taken live on.
void motorcade_tracker_destroy(motorcade_tracker* tracker);
/// Copies the pixels. MOTORCADE_OK: see `push` for whether the pair was accepted. An image may be NULL: it is rejected.
motorcade_code motorcade_tracker_push(motorcade_tracker* tracker, const motorcade_pair* pair, motorcade_push* push);
typedef struct {
  size_t struct_size;
  int64_t stamp_ns;                              // on the clock of the pairs
  double speed_mps, yaw_rate_radps;              // of the rear axle's middle: positive ahead; to the left
  double speed_sigma_mps, yaw_rate_sigma_radps;  // standard deviations; 0: estimated
} motorcade_vehicle_motion;
/// The vehicle's own motion, which predicts the camera where images fail; see motorcade.hpp. For any thread.
motorcade_code motorcade_tracker_push_motion(motorcade_tracker* tracker, const motorcade_vehicle_motion* motion,
                                             motorcade_push* push);
/// No further pair comes: the results of those that were accepted still do.
motorcade_code motorcade_tracker_close(motorcade_tracker* tracker);
/// Forgets the drive, and what was not taken: the next pair begins a new one; see motorcade.hpp.
motorcade_code motorcade_tracker_reset(motorcade_tracker* tracker);
/// MOTORCADE_OK: the next result, which the caller releases. MOTORCADE_NONE, MOTORCADE_DONE: NULL.
motorcade_code motorcade_tracker_poll(motorcade_tracker* tracker, motorcade_result** result);
motorcade_code motorcade_tracker_wait(motorcade_tracker* tracker, int64_t timeout_ms, motorcade_result** result);
motorcade_code motorcade_tracker_done(const motorcade_tracker* tracker, bool* done);
/// Sends results, first those that wait, to `take`, on a thread of the tracker. It releases them and may call all but
/// destroy. NULL: to poll and wait again.
typedef void (*motorcade_take)(motorcade_result* result, void* user);
motorcade_code motorcade_tracker_on_result(motorcade_tracker* tracker, motorcade_take take, void* user);
/// The same for frames that have left the smoothing window; see motorcade.hpp. NULL: nobody wants them.
motorcade_code motorcade_tracker_on_final(motorcade_tracker* tracker, motorcade_take take, void* user);
motorcade_code motorcade_tracker_counts(const motorcade_tracker* tracker, motorcade_counts* counts);
/// Lost and rejected: the pose is predicted, with a wide covariance.
typedef enum { MOTORCADE_STATUS_GOOD, MOTORCADE_STATUS_LOST, MOTORCADE_STATUS_REJECTED } motorcade_status;
/// Cause of a status other than simply good. Good with a cause: measured, but less surely.
// clang-format off
typedef enum { MOTORCADE_CAUSE_NONE, MOTORCADE_CAUSE_AFTER_GAP, MOTORCADE_CAUSE_FEW_POINTS, MOTORCADE_CAUSE_NO_POINTS,
  MOTORCADE_CAUSE_UNLINKED, MOTORCADE_CAUSE_FAILED, MOTORCADE_CAUSE_UNUSABLE, MOTORCADE_CAUSE_OUT_OF_ORDER,
  MOTORCADE_CAUSE_TOO_LATE } motorcade_cause;
typedef enum { MOTORCADE_KIND_UNKNOWN, MOTORCADE_KIND_CAR, MOTORCADE_KIND_LARGE_VEHICLE, MOTORCADE_KIND_TWO_WHEELER,
  MOTORCADE_KIND_PEDESTRIAN } motorcade_kind;
// clang-format on
typedef struct {
  size_t struct_size;
  int64_t frame, stamp_ns;
  motorcade_status status;
  motorcade_cause cause;
  int segment;                                    // + 1 where no measurement links the poses before and after
  int dropped_before;                             // pairs since the result before that a newer one replaced
  double T_world_cam[12], motion_covariance[36];  // the latter of T_cam(before)_cam(now)
  double velocity[6], velocity_covariance[36];    // own, since the last frame seen, in its axes [m/s], [rad/s]
  bool has_motion_covariance;
  size_t object_count;
  double latency_ms;    // from push to the result
  const char* problem;  // why the pair was lost or rejected, or the rig is wrong; lives as long as the result
  bool has_pose_covariance;
  double pose_covariance[36];  // of T_world_cam, relative to the frame that defines the world: grows with distance
} motorcade_frame;
typedef enum { MOTORCADE_STATE_MOVING, MOTORCADE_STATE_STOPPED, MOTORCADE_STATE_PREDICTED } motorcade_state;
typedef struct {
  size_t struct_size;
  int64_t id;                                               // never used twice by one tracker
  motorcade_state state;                                    // predicted: not seen in this frame
  int points;                                               // seen on it in this frame
  double T_world_body[12], T_cam_body[12], covariance[36];  // the latter of T_cam_body
  double velocity_world_mps[3];                             // of the body's origin, over ground
  double velocity_covariance[9];                            // [m^2/s^2], the camera's own drift left out
  double yaw_rate_radps, yaw_rate_sigma_radps, age_s;       // about the body's z axis; since it was first reported
  double image_box_px[4];                                   // left, top, right, bottom in the left image, inclusive
  double box_center_body_m[3], box_size_m[3], box_size_sigma_m[3];  // the cuboid on the ground; length 0: not known yet
  motorcade_kind kind;
  bool has_covariance;
  double kind_probability, existence_probability;  // the latter that it is there and moves, or moved before
  /// Changes of its speed and of its yaw rate; NaN in its first frame, and where the back-end cannot tell.
  double acceleration_mps2, acceleration_sigma_mps2, yaw_acceleration_radps2, yaw_acceleration_sigma_radps2;
  double box_center_sigma_m[3];  // along the body's axes
} motorcade_object;
typedef struct {
  size_t struct_size;
  int left_px, top_px, cell_px, width_cells, height_cells;  // of the left image; cells of `cell_px` pixels each way
  const uint8_t* inside;  // row by row, 1 where the object is seen; lives as long as the result
} motorcade_mask;
/// Objects count from 0 to below `object_count`, by id. MOTORCADE_NONE: without `masks`, or no outline was found.
motorcade_code motorcade_result_frame(const motorcade_result* result, motorcade_frame* frame);
motorcade_code motorcade_result_object(const motorcade_result* result, size_t index, motorcade_object* object);
motorcade_code motorcade_result_mask(const motorcade_result* result, size_t index, motorcade_mask* mask);
void motorcade_result_release(motorcade_result* result);
/// Reads a recorded drive, one thread at a time. Its pixels live until the next call; an unreadable image has none.
motorcade_code motorcade_recording_open(const char* folder, motorcade_recording** recording);
motorcade_code motorcade_recording_camera(const motorcade_recording* recording, motorcade_camera* camera);
motorcade_code motorcade_recording_size(const motorcade_recording* recording, int64_t* size);
motorcade_code motorcade_recording_read(motorcade_recording* recording, int64_t index, motorcade_pair* pair);
void motorcade_recording_close(motorcade_recording* recording);
#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop
