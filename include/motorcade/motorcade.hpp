#pragma once

/// Motorcade: follows a car's own path and the moving vehicles around it from one stereo camera.
///
///   motorcade::Tracker tracker(camera, options);       // throws Error, naming the field
///   tracker.push({.left = {pixels, width, height}, .right = ..., .stamp_ns = stamp});
///   while (const auto result = tracker.wait(100ms)) use(*result);
///
/// Units are in the names: meters, seconds, radians, pixels, integer nanoseconds of the capture clock. `T_a_b` takes
/// coordinates in b to coordinates in a, p_a = T_a_b * p_b: the upper three rows of a 4x4 matrix, row by row. Frames:
///   cam    the left camera, rectified: x right, y down, z ahead (optical, as in OpenCV); with `Axes::kRep103` x ahead,
///          y left, z up (as ROS wants of bodies)
///   world  the cam of the first frame that shows points
///   body   of an object, fixed to it: x as it traveled when it was confirmed, y left, z up, with either axes
/// Covariances are row by row, of (rho, phi) in T exp(rho, phi) [m, rad]. Those of the camera's pose and motion and of
/// objects' positions and velocities include typical errors of a calibration; the others do not.
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#define MOTORCADE_API __attribute__((visibility("default")))
#define MOTORCADE_INTERNAL __attribute__((visibility("hidden")))

namespace motorcade {

/// A request that cannot be met. `field` names the input to fix, as `camera.baseline_m`; the message says how.
class MOTORCADE_API Error : public std::runtime_error {
 public:
  Error(std::string field, const std::string& message)
      : runtime_error(field + ": " + message), field_(std::move(field)) {}
  ~Error() override;
  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

/// The stereo camera of rectified pairs. With `rig`, the pairs are not rectified yet, and the tracker rectifies them.
struct Camera {
  int width_px = 0, height_px = 0;                                    // of the images that are pushed
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0, baseline_m = 0;  // rectified; not read where there is a rig
  enum class Distortion { kNone, kRadialTangential, kEquidistant };
  struct Lens {
    double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
    Distortion distortion = Distortion::kNone;
    std::array<double, 8> coefficients{};  // k1 k2 p1 p2 k3 k4 k5 k6 as OpenCV orders them; equidistant: k1 k2 k3 k4
  };
  struct Rig {
    Lens left, right;
    std::array<double, 12> T_right_left{};
  };
  std::optional<Rig> rig{};
  /// Useless pixels of the rectified left image: dead ones, borders, logos. They are so many columns and rows at the
  /// sides, and the pixels of the mask, row by row, that are not 0. A hood is found without it.
  struct Ignored {
    int left_px = 0, top_px = 0, right_px = 0, bottom_px = 0;
    std::vector<std::uint8_t> mask{};  // of width_px x height_px, or empty
  };
  Ignored ignored{};
  /// Standard deviations of the calibration's errors, which stay constant. The covariances named above include them.
  /// Zeros: the calibration is exact. Empty: the values below, or those in `Options::settings`.
  struct Sigmas {
    double focal = 0.002;        // of the focal length of both cameras, as a share
    double middle_px = 0.7;      // of the principal point of both, each way
    double distortion = 0.01;    // of the radial term k1 of both; of the tangential ones a tenth
    double baseline = 0.001;     // as a share
    double disparity_px = 0.15;  // in the middle of the image, as the right camera is turned
  };
  std::optional<Sigmas> sigmas{};
};

/// One moment's two images. The pixels are copied by `Tracker::push`.
struct Pair {
  /// Color becomes gray by BT.601. Of kGray16 the upper eight of 8, 10, 12, 14 or 16 bits are used: as many bits as
  /// hold the brightest sample of the first pair with one above 255. That holds for all pairs, and the log tells it.
  enum class Format { kGray8, kGray16, kRgb8, kBgr8 };
  struct Image {
    const void* pixels = nullptr;
    int width_px = 0, height_px = 0;
    std::int64_t stride_bytes = 0;  // from row to row, downwards; 0: rows without gaps
    Format format = Format::kGray8;
  };
  Image left{}, right{};
  std::int64_t stamp_ns = 0;  // capture time, after that of the pair before
  std::int64_t frame = -1;    // number, from 0, after that of the pair before; -1: the next one
  /// Instance labels of the left image, as a network tells them: one number for the pixels of one body, 0 for none.
  /// They are rectified, of the camera's size, kGray8 or kGray16, or without pixels. They are evidence and no more:
  /// labels may be late, change from pair to pair, and lie. With the first ones `push` allocates their room.
  Image instances{};
};

/// The motion of the rear axle's middle, as the vehicle's own sensors tell it.
struct VehicleMotion {
  std::int64_t stamp_ns = 0;                             // on the clock of the pairs
  double speed_mps = 0, yaw_rate_radps = 0;              // positive ahead; about the upward axis, to the left
  double speed_sigma_mps = 0, yaw_rate_sigma_radps = 0;  // standard deviations; 0: estimated
};

/// Estimates of one frame, given as soon as they are known.
struct Result {
  enum class Status { kGood, kLost, kRejected };  // lost and rejected: the pose is predicted, with a wide covariance
  /// Good, but less sure: measured across missing frames (kAfterGap), or by barely enough points (kFewPoints). Lost: no
  /// point is found again, as in the dark (kNoPoints); points do not tell the camera's motion (kUnlinked); an internal
  /// fault (kFailed). Rejected: the images are unusable (kUnusable). Only finals are rejected for the last two: `push`
  /// refused the pair for its stamp (kOutOfOrder), or a newer pair replaced it (kTooLate).
  enum class Cause { kNone, kAfterGap, kFewPoints, kNoPoints, kUnlinked, kFailed, kUnusable, kOutOfOrder, kTooLate };
  enum class State { kMoving, kStopped, kPredicted };  // stopped: moved before; predicted: not seen in this frame
  enum class Kind { kUnknown, kCar, kLargeVehicle, kTwoWheeler, kPedestrian };
  /// The left image's pixels that show an object: cells of `cell_px` pixels each way, row by row, 1 where it is seen.
  struct Mask {
    int left_px = 0, top_px = 0, cell_px = 1, width_cells = 0, height_cells = 0;
    std::vector<std::uint8_t> inside{};
  };
  struct Acceleration {  // how an object's speed and its yaw rate change, with standard deviations
    double along_mps2 = 0, along_sigma_mps2 = 0;  // along its path: positive where it becomes faster
    double yaw_radps2 = 0, yaw_sigma_radps2 = 0;  // about the body's z axis
  };
  struct Object {
    std::int64_t id = -1;  // never used twice by one tracker
    State state = State::kMoving;
    std::array<double, 12> T_world_body{}, T_cam_body{};
    std::optional<std::array<double, 36>> covariance{};   // of T_cam_body
    std::array<double, 3> velocity_world_mps{};           // of the body's origin, over ground
    std::array<double, 9> velocity_covariance{};          // [m^2/s^2], the camera's own drift left out
    double yaw_rate_radps = 0, yaw_rate_sigma_radps = 0;  // about the body's z axis
    double age_s = 0, existence_probability = 1;  // since it was first reported; that it is there and moves, or moved
    int points = 0;                               // seen on it in this frame
    std::array<double, 4> image_box_px{};         // left, top, right, bottom in the left image, inclusive
    /// The cuboid along the body's axes, its bottom on the ground; length 0 where it is not known yet.
    std::array<double, 3> box_center_body_m{}, box_size_m{}, box_size_sigma_m{};  // length, width, height
    std::array<double, 3> box_center_sigma_m{};                                   // along the body's axes
    Kind kind = Kind::kUnknown;
    double kind_probability = 0;
    std::optional<Mask> mask{};                  // with `Options::masks`, where the outline was found
    std::optional<Acceleration> acceleration{};  // empty in its first frame, and where the back-end cannot tell
  };
  std::int64_t frame = -1, stamp_ns = 0;  // of the pair; they go on where its numbers or clock were set back
  Status status = Status::kGood;
  Cause cause = Cause::kNone;
  int segment = 0;  // increases by one where no measurement links the poses before and after
  std::array<double, 12> T_world_cam{};
  /// Covariance of T_world_cam relative to the frame that defines the world; grows with distance. Empty after a gap.
  std::optional<std::array<double, 36>> pose_covariance{};
  /// Covariance of T_cam(before)_cam(now). Before is `Options::covariance_frames` ago, or the last result before that.
  std::optional<std::array<double, 36>> motion_covariance{};
  /// The camera's velocity along its axes [m/s] and about them [rad/s], since the last frame that was seen.
  std::array<double, 6> velocity{};
  std::array<double, 36> velocity_covariance{};
  std::vector<Object> objects{};  // by id
  int dropped_before = 0;         // pairs since the result before that a newer one replaced
  double latency_ms = 0;          // from `push` to the result
  std::string problem{};          // why the pair is of no use, what failed or is wrong with the rig; else see `cause`
};

/// Follows the camera and the objects. One thread pushes, one takes results; every other call is for any thread.
/// Several trackers in one process share nothing but the processors. Cannot be copied.
class MOTORCADE_API Tracker {
 public:
  enum class Policy {
    kLive,    // the newest pair wins: `push` never waits, and asks nothing of the heap
    kReplay,  // no pair is lost: `push` waits for room; results do not depend on time or threads
  };
  enum class Axes { kOptical, kRep103 };
  enum class LogLevel { kInfo, kWarning, kError };
  struct Options {
    Policy policy = Policy::kLive;
    Axes axes = Axes::kOptical;
    bool masks = false;
    int threads = 2;                           // 1 to 64, at most one per processor is used
    int realtime_priority = 0;                 // of its threads: 1 to 99 is SCHED_FIFO, which may need a privilege
    std::vector<int> cpus{};                   // that its threads may run on; empty: all
    std::chrono::milliseconds patience{5000};  // replay: a `push` waits so long at most for results to be taken
    int covariance_frames = 10;                // that `Result::motion_covariance` reaches back: 1 to 60
    std::string settings{};                    // lines of the program's configuration: "backend.kind = 'filter'"
    std::function<void(LogLevel, const std::string&)> log{};  // called from its threads, several at once
  };
  struct Push {
    enum class Status { kAccepted, kReplacedOlder, kRejected };
    Status status = Status::kAccepted;  // replaced: accepted, and an older pair that still waited is dropped
    const char* why = "";               // it was rejected; static text
  };
  struct Counts {
    std::int64_t pushed = 0, rejected = 0;  // by `push`; no result comes of a rejected pair
    std::int64_t dropped = 0;               // replaced by a newer one
    std::int64_t results = 0, untaken = 0;  // given so far; lost since nobody took them (live: beyond 256)
  };
  /// Throws Error, or std::bad_alloc. `options` keep their defaults where they are not given.
  Tracker(const Camera& camera, const Options& options);
  explicit Tracker(const Camera& camera);
  /// Abandons what is in flight, ends calls that wait in other threads, and joins its own threads. A child of `fork`
  /// has none of these threads, and only drops what it inherited.
  ~Tracker();
  /// Rejects a pair without pixels, a pair or labels of another size than the camera's, a pair after `close`, and one
  /// beside another thread's push. Rejects a stamp less than half a millisecond after the last one, as stamps in
  /// another unit are. A clock or numbers that were set back are followed after four pairs.
  Push push(const Pair& pair) noexcept;
  /// Predicts the camera where images fail. Any thread may call it, at its own rate, late and out of order; a pair
  /// knows the samples before it. An accepted sample is stored; if it contradicts the images it is left out, and only
  /// `log` tells. Rejects values out of range, and samples after `close`.
  Push push_motion(const VehicleMotion& motion) noexcept;
  void close() noexcept;  // no further pair comes: the results of those that were accepted still do
  /// Forgets the drive, what is in flight, and results that nobody took. The next pair, also after `close`, begins a
  /// new world with its own stamps and numbers. Ids and counts go on, callbacks stay. Not by `log` or that of finals.
  void reset();
  std::optional<Result> poll();  // the next result if there is one already
  /// Waits for the next result; empty when time is up, and at once when no further result will come (`done`).
  std::optional<Result> wait(std::chrono::milliseconds timeout);
  bool done() const noexcept;
  /// Sends results, first those that wait, to this callback, one by one on a thread of the tracker; empty: to `poll`
  /// and `wait` again. The previous callback has returned by then. It may throw, and call all but ~Tracker.
  void on_result(std::function<void(Result)> take);
  /// Sends each frame once and in order, dropped ones too, to this callback when it leaves the smoothing window, the
  /// last ones after `close`. They are as in the final files, without velocity, masks and latency. Later results and
  /// `done` wait for it. Empty: to nobody. It may call all but `wait`, `reset`, ~Tracker, and `push` in replay.
  void on_final(std::function<void(Result)> take);
  Counts counts() const noexcept;

 private:
  class MOTORCADE_INTERNAL Impl;
  std::unique_ptr<Impl> impl_;
};

/// A recorded drive: a folder of KITTI, EuRoC, Argoverse or plain images (docs/formats.md).
class MOTORCADE_API Recording {
 public:
  explicit Recording(const std::string& folder);  // throws Error
  ~Recording();
  Camera camera() const;  // rectified, as the pairs are
  std::int64_t size() const;
  /// The pixels live until the next call. An image that cannot be read has none, and the tracker rejects the pair.
  Pair read(std::int64_t index);

 private:
  class MOTORCADE_INTERNAL Impl;
  std::unique_ptr<Impl> impl_;
};

MOTORCADE_API const char* version() noexcept;  // as "0.1.0"

}  // namespace motorcade
